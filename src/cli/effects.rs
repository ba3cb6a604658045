//! `servoscope effects`: what the library has, as a list or as pages with figures.

mod figure;

use std::fmt::Write as _;
use std::path::PathBuf;

use rayon::prelude::*;
use servoscope_core::effects::{ALL, Descriptor, Dimension, find};

use super::{Failure, target, terminal};

/// Arguments of `effects`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Writes README.md, which describes every effect, and a figure of each into this folder
    /// [default: lists them on standard output].
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// Lists the effects, or writes their pages.
pub(super) fn run(args: &Args) -> Result<(), Failure> {
    let descriptors = ALL.iter().map(|effect| effect.descriptor());
    let Some(folder) = &args.output else {
        return terminal::print(&descriptors.map(listed).collect::<String>());
    };
    target::folder(folder)?;
    let write = |name: &str, text: &str| {
        let path = folder.join(name);
        std::fs::write(&path, text).map_err(|error| Failure::unwritten(&path, &error))
    };
    write("README.md", &page(descriptors))?;
    ALL.par_iter().try_for_each(|effect| {
        let svg = figure::draw(*effect).map_err(Failure::other)?;
        write(&format!("{}.svg", effect.id()), &svg)
    })
}

/// An effect as it is given to `simulate --effect`.
fn listed(effect: &Descriptor) -> String {
    let mut text = format!("{}: {}\n    {}\n", effect.id, effect.title, effect.equation);
    for parameter in effect.parameters {
        let (name, title, unit) = (parameter.name, parameter.title, unit(parameter.dimension));
        let _ = writeln!(text, "    {name}: {title}, {unit}, {}", parameter.domain.words());
    }
    text
}

/// The page that describes all effects.
fn page<'a>(effects: impl Iterator<Item = &'a Descriptor>) -> String {
    let begin = "# The effects, one by one\n\nWritten by `servoscope effects --output \
                 docs/effects`. The figures show an effect of typical size on an axis with pole \
                 −10 rad/s, constant 10 and dry friction 0.5 and 0.4: one period of the velocity \
                 where the effect shows most, and what it does to gain and phase of the \
                 fundamental. Units are those of the measurement: `input` is the unit of the \
                 input, `velocity` that of the velocity, `position` that of the velocity times \
                 second.\n";
    effects.fold(begin.to_owned(), |text, effect| text + &section(effect))
}

fn section(effect: &Descriptor) -> String {
    let Descriptor { id, title, equation, meaning, signature, .. } = effect;
    let (title, meaning, signature) = (capital(title), capital(meaning), untold(signature));
    let mut text = format!(
        "\n## {title}\n\n`{id}`: {equation}\n\n{meaning}. How it shows: {signature}.\n\n\
         | parameter | what it is | unit | values |\n| --- | --- | --- | --- |\n"
    );
    for parameter in effect.parameters {
        let (name, unit) = (parameter.name, unit(parameter.dimension));
        let values = parameter.domain.words();
        let _ = writeln!(text, "| `{name}` | {} | {unit} | {values} |", parameter.title);
    }
    let alike = effect.imitators.iter().filter_map(|id| find(id)).map(|effect| {
        let title = effect.descriptor().title;
        format!("[{title}](#{})", title.to_lowercase().replace(' ', "-"))
    });
    let alike: Vec<String> = alike.collect();
    if !alike.is_empty() {
        let _ = writeln!(text, "\nLooks like it: {}.", alike.join(", "));
    }
    let _ = writeln!(text, "\n![{title}: velocity, gain and phase with and without it]({id}.svg)");
    text
}

/// A text of the library where no units are known.
fn untold(text: &str) -> String {
    text.replace("torque", "force or torque")
}

fn capital(text: &str) -> String {
    let text = untold(text);
    let mut characters = text.chars();
    characters
        .next()
        .map_or(String::new(), |first| first.to_uppercase().chain(characters).collect())
}

/// A dimension in the units of the measurement; a velocity times a time is a position.
fn unit(dimension: Dimension) -> String {
    let Dimension { input, velocity, time } = dimension;
    let motion = match velocity * time > 0 {
        true => [("position", velocity), ("s", time - velocity)],
        false => [("velocity", velocity), ("s", time)],
    };
    let powers = [("input", input), motion[0], motion[1]];
    let side = |sign: i8| {
        let factors = powers.iter().filter(|(_, power)| power * sign > 0);
        let factor = |(name, power): &(&str, i8)| match power.abs() {
            1 => (*name).to_owned(),
            power => format!("{name}^{power}"),
        };
        factors.map(factor).collect::<Vec<_>>()
    };
    let (above, below) = (side(1), side(-1));
    let numerator = if above.is_empty() { "1".to_owned() } else { above.join("·") };
    match below.as_slice() {
        [] => numerator,
        [one] => format!("{numerator}/{one}"),
        _ => format!("{numerator}/({})", below.join("·")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_unit_is_written_as_a_fraction() {
        let cases = [
            (Dimension::NONE, "1"),
            (Dimension::INPUT, "input"),
            (Dimension::INPUT.per(Dimension::POSITION), "input/position"),
            (Dimension { input: 1, velocity: -3, time: -3 }, "input/position^3"),
            (Dimension::NONE.per(Dimension::TIME), "1/s"),
            (Dimension { input: 1, velocity: -2, time: 0 }, "input/velocity^2"),
        ];
        for (dimension, written) in cases {
            assert_eq!(unit(dimension), written);
        }
    }

    #[test]
    fn every_effect_is_listed_with_its_parameters_and_described_with_its_figure() {
        let page = page(ALL.iter().map(|effect| effect.descriptor()));
        for effect in ALL {
            let descriptor = effect.descriptor();
            let listed = listed(descriptor);
            assert!(listed.starts_with(&format!("{}: ", effect.id())), "{listed}");
            assert!(page.contains(&format!("]({}.svg)", effect.id())), "{page}");
            for parameter in effect.parameters() {
                assert!(listed.contains(&format!("    {}: ", parameter.name)), "{listed}");
                assert!(page.contains(&format!("| `{}` | ", parameter.name)), "{page}");
            }
        }
    }
}
