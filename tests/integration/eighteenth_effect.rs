//! What a new effect takes: one file like this one, and a line in the list of effects.
//!
//! The effect is a drag that grows with the cube of the velocity, which the library lacks. Its
//! physics is in the benchmark's simulator already, among the outsiders: that file is the only
//! other one a new effect needs. See `docs/adding-an-effect.md`.

use servoscope_bench::machines::draw::{Draw, draw, measure};
use servoscope_bench::machines::simulator;
use servoscope_core::answers::{IdentifyOptions, PlantRequest, Verdict};
use servoscope_core::diagnose::diagnose;
use servoscope_core::effects::{
    ALL, Axis, Coordinate, Descriptor, Dimension, Domain, DrawPlan, Draws, Effect, Form,
    LAW_PARAMETERS, Law, Library, MachineScales, Parameter, Partials, Range, SearchPlan, Slot,
    Wide, up_to,
};
use servoscope_core::identify::IdentifyRequest;
use servoscope_core::observer::Silent;

/// c.
#[derive(Debug)]
struct CubicDrag;

const PARAMETERS: [Parameter; 1] = [Parameter {
    name: "c",
    title: "drag coefficient",
    symbol: ["c", ""],
    dimension: Dimension { input: 1, velocity: -3, time: 0 },
    domain: Domain::NotNegative,
    coordinate: Coordinate::Linear,
    // As much torque at the largest velocity as there is.
    range: |scope| {
        let most = scope.largest_level / scope.largest_velocity.powi(3);
        Range { bounds: [0.0, 20.0 * most], likely: [0.0, most], absent: Some(0.0) }
    },
}];

/// c·v³.
#[derive(Debug)]
struct Cube;

impl Form for Cube {
    fn at(&self, [c, ..]: &[f64; LAW_PARAMETERS], velocity: f64, _position: f64) -> Partials {
        let square = velocity * velocity;
        Partials {
            value: c * square * velocity,
            by_velocity: 3.0 * c * square,
            by_position: 0.0,
            by_parameter: [square * velocity, 0.0, 0.0],
        }
    }

    fn uses_position(&self) -> bool {
        false
    }

    fn contracts(&self) -> bool {
        true
    }
}

const DESCRIPTOR: Descriptor = Descriptor {
    id: "cubic_drag",
    title: "cubic drag",
    with_article: "cubic drag",
    equation: "g += c·v³",
    meaning: "a drag grows with the cube of the speed",
    signature: "the gain falls as the magnitude grows, most below the pole",
    imitators: &["quadratic_drag"],
    slot: Slot::Torque,
    parameters: &PARAMETERS,
    search: SearchPlan::DEFAULT,
    draw: DrawPlan {
        draw: |scales, draws| {
            vec![scales.lowest / scales.velocity().powi(3) * draws.log_uniform(0.01, 0.2)]
        },
        scaled: |scales, values, factor| {
            Some(vec![up_to(values[0], factor, 3.0 * scales.lowest / scales.velocity().powi(3))?])
        },
        by_character: None,
    },
};

impl Effect for CubicDrag {
    fn descriptor(&self) -> &'static Descriptor {
        &DESCRIPTOR
    }

    fn enter(&self, parameters: &[Wide], _run_share: f64, axis: &mut Axis<Wide>) {
        axis.torques.push(Law::new(&Cube, parameters));
    }
}

/// The middle of every range.
struct Middle;

impl Draws for Middle {
    fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        (low * high).sqrt()
    }

    fn signed(&mut self, low: f64, high: f64) -> f64 {
        0.5 * (low + high)
    }
}

/// A machine with the effect, of the size that its descriptor draws.
fn machine() -> (Draw, f64) {
    let mut machine = draw(0, 3);
    let magnitudes = || machine.design.iter().map(|(magnitude, _)| *magnitude);
    let friction = machine.plant.friction;
    let scales = MachineScales {
        viscous_rate: machine.plant.viscous_rate_rad_s,
        constant: machine.plant.constant,
        coulomb: [friction.fc_plus, friction.fc_minus],
        lowest: magnitudes().fold(f64::INFINITY, f64::min),
        highest: magnitudes().fold(0.0, f64::max),
        fastest_rad_s: machine.design.iter().map(|(_, omega)| *omega).fold(0.0, f64::max),
    };
    let values = (DESCRIPTOR.draw.draw)(&scales, &mut Middle);
    machine.effects = vec![simulator::Effect::of("cubic_drag", &values)];
    (machine, values[0])
}

// Without the effect in the list the same data must have another name or none: the name is due to
// the list alone.
#[test]
fn an_effect_in_the_list_is_searched_for_fitted_and_named_without_anything_else() {
    let (machine, c) = machine();
    let measurement = measure(&machine, 5).unwrap();
    let mut options = IdentifyOptions::default();
    options.network.enabled = false;
    options.colony.enabled = false;
    let plant = Some(PlantRequest { actuator_order: 0 });
    let request = IdentifyRequest { plant, options, ..IdentifyRequest::default() };
    let eighteen: Vec<&'static dyn Effect> = ALL.iter().copied().chain([&CubicDrag as _]).collect();
    let library = Library(eighteen.leak());
    let answer = diagnose(&measurement, &IdentifyRequest { library, ..request }, &Silent).unwrap();
    assert_eq!(answer.verdict, Verdict::Explained);
    let names: Vec<&str> = answer.causes.iter().map(|cause| cause.effect.as_str()).collect();
    assert_eq!(names, ["cubic_drag"]);
    let found = &answer.causes[0].parameters["c"];
    let (value, std) = (found.value.unwrap(), found.std.unwrap());
    // Four standard deviations: chance exceeds them once in 16 000.
    assert!((value - c).abs() < 4.0 * std, "{value} ± {std} instead of {c}");
    assert!(answer.causes[0].explanation.starts_with("a drag grows with the cube of the speed."));

    let without = diagnose(&measurement, &request, &Silent).unwrap();
    assert!(without.causes.iter().all(|cause| cause.effect != "cubic_drag"));
}
