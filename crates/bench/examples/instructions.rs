//! Does one piece of work whose instructions `benches/instructions.sh` counts.
//!
//! Without arguments it prints the names of all pieces, with a name it does that piece. Everything
//! runs in one thread of the pool, so that the count does not depend on what is handed from thread
//! to thread.

use std::hint::black_box;

use servoscope_bench::naming::effect_draws::ids;
use servoscope_bench::workloads::axes::AxisWithEffect;
use servoscope_bench::workloads::tables::{Hidden, g1, measured, order_given};
use servoscope_core::diagnose::diagnose;
use servoscope_core::identify::identify;
use servoscope_core::observer::Silent;

/// Work that is ready to be done.
type Work = Box<dyn Fn() + Send + Sync>;

/// How a piece of work is made ready.
type Prepare = fn() -> Work;

/// Every piece of work by name.
const PIECES: [(&str, Prepare); 3] = [
    ("points_with_gradient", points_with_gradient),
    ("identification", identification),
    ("diagnosis", diagnosis),
];

/// Each effect of the library at the 48 points of a machine's design.
fn points_with_gradient() -> Work {
    let axes: Vec<_> = ids().into_iter().map(|id| AxisWithEffect::draw(id, 0, 1)).collect();
    Box::new(move || {
        for (axis, point) in axes.iter().flat_map(|axis| axis.points.iter().map(move |p| (axis, p)))
        {
            let _ = black_box(axis.respond_with_gradient(point));
        }
    })
}

/// G1 with the order of its actuator given and all other options at their defaults.
fn identification() -> Work {
    let (measurement, request) = (measured(&g1()), order_given(&g1()));
    Box::new(move || {
        black_box(identify(&measurement, &request, &Silent).expect("an answer"));
    })
}

/// A machine that hides static friction, at every eighth point of its design with 6 harmonics each:
/// a small table, because counting takes forty times as long as running.
fn diagnosis() -> Work {
    let mut machine = Hidden::One.machine();
    machine.harmonics = 5;
    machine.design = machine.design.into_iter().step_by(8).collect();
    let (measurement, request) = (measured(&machine), order_given(&machine));
    Box::new(move || {
        black_box(diagnose(&measurement, &request, &Silent).expect("an answer"));
    })
}

/// The function whose instructions are counted, with all that it calls.
#[inline(never)]
fn work_under_count(work: &Work) {
    work();
}

fn main() {
    let Some(asked) = std::env::args().nth(1) else {
        PIECES.iter().for_each(|(name, _)| println!("{name}"));
        return;
    };
    let piece = PIECES.iter().find(|(name, _)| *name == asked);
    let (_, prepare) = piece.unwrap_or_else(|| panic!("`{asked}` is no piece of work"));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    pool.install(|| work_under_count(&prepare()));
}
