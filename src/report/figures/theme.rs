//! Colours, light and dark.
//!
//! Every colour is a class of the style sheet inside the figure, so that one
//! file suits both schemes. Rules are written out for each scheme rather than
//! with CSS variables, which many SVG renderers do not know. Selectors begin
//! with the figure's own id: figures may stand side by side in one page.

use std::fmt::Write as _;
use std::str::FromStr;

/// Which colours a figure is drawn in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Theme {
    /// Those the reader prefers (`prefers-color-scheme`); on paper dark on light.
    #[default]
    Auto,
    /// Dark on light.
    Light,
    /// Light on dark.
    Dark,
}

impl Theme {
    /// Every theme, in the order they are listed to a user.
    pub const ALL: &[Theme] = &[Theme::Auto, Theme::Light, Theme::Dark];

    /// The name used on the wire and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Theme::Auto => "auto",
            Theme::Light => "light",
            Theme::Dark => "dark",
        }
    }
}

/// How a figure is written: its colours and its size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Format {
    /// Its colours.
    pub theme: Theme,
    /// Width, pixels; `None`: as the height has it, 800 without one.
    pub width: Option<u32>,
    /// Height, pixels; `None`: as the width has it. With both, the figure is as
    /// large as fits in.
    pub height: Option<u32>,
}

impl From<Theme> for Format {
    fn from(theme: Theme) -> Self {
        Self { theme, ..Self::default() }
    }
}

impl Format {
    /// Width and height of a figure that was drawn in a size of its own.
    pub(super) fn size(self, [drawn_width, drawn_height]: [f64; 2]) -> [f64; 2] {
        let [width, height] = [self.width, self.height].map(|side| side.map(f64::from));
        let in_proportion = |side: f64, from: f64, to: f64| (side * to / from).round().max(1.0);
        match (width, height) {
            (None, None) => [drawn_width, drawn_height],
            (Some(width), None) => [width, in_proportion(width, drawn_width, drawn_height)],
            (None, Some(height)) => [in_proportion(height, drawn_height, drawn_width), height],
            (Some(width), Some(height)) => [width, height],
        }
    }
}

impl FromStr for Theme {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Theme::ALL.iter().copied().find(|theme| theme.name() == text).ok_or_else(|| {
            let known = Theme::ALL.iter().map(|theme| theme.name()).collect::<Vec<_>>();
            format!("there is no theme `{text}`; known: {}", known.join(", "))
        })
    }
}

/// Lower ends of the classes of residual size, standard deviations: the first
/// two are what noise looks like.
pub(super) const SIGMA_CLASSES: [f64; 8] = [0.0, 1.0, 2.0, 3.0, 5.0, 10.0, 30.0, 100.0];

/// Colours of one scheme, for figures and for the page around them.
pub(in crate::report) struct Palette {
    pub background: &'static str,
    pub text: &'static str,
    pub muted: &'static str,
    pub frame: &'static str,
    pub grid: &'static str,
    pub minor: &'static str,
    /// Ends and middle of the ordered colours of series: contrast with the
    /// background grows towards the last, and hue and lightness both change,
    /// so that readers with any colour vision see the order.
    series: [[f64; 3]; 3],
    /// Perceptually ordered, one a class of [`SIGMA_CLASSES`]: greys for what
    /// may be noise, then a heat scale whose lightness is monotonic.
    sigma: [&'static str; SIGMA_CLASSES.len()],
}

pub(in crate::report) const LIGHT: Palette = Palette {
    background: "#ffffff",
    text: "#15191e",
    muted: "#56606b",
    frame: "#8b949e",
    grid: "#e1e5e9",
    minor: "#f1f3f5",
    series: [[212.0, 112.0, 0.0], [190.0, 38.0, 112.0], [38.0, 28.0, 130.0]],
    sigma: ["#eef0f2", "#dde1e5", "#fbd8a3", "#f6a95f", "#e8704b", "#c23b5c", "#861b69", "#3f1059"],
};

pub(in crate::report) const DARK: Palette = Palette {
    background: "#14181d",
    text: "#eef1f4",
    muted: "#a3adb8",
    frame: "#66707b",
    grid: "#2b323a",
    minor: "#1e242a",
    series: [[255.0, 190.0, 92.0], [242.0, 112.0, 160.0], [134.0, 126.0, 255.0]],
    sigma: ["#22282f", "#333b44", "#55296a", "#86327c", "#bb4075", "#e4644e", "#f7a24a", "#fde693"],
};

impl Palette {
    /// Colour `index` of `count` ordered ones.
    pub fn series(&self, index: usize, count: usize) -> String {
        let share = if count > 1 { index as f64 / (count - 1) as f64 } else { 1.0 };
        let (low, part) = if share < 0.5 { (0, 2.0 * share) } else { (1, 2.0 * share - 1.0) };
        let mix = |i: usize| {
            let [from, to] = [low, low + 1].map(|anchor| self.series[anchor][i]);
            (from + part * (to - from)).round() as u8
        };
        format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
    }

    fn rules(&self, id: &str, series: usize) -> String {
        let mut rules: Vec<(String, String)> = vec![
            ("text".into(), format!("fill:{}", self.text)),
            (".m".into(), format!("fill:{}", self.muted)),
            (".bg".into(), format!("fill:{}", self.background)),
            (".frame".into(), format!("stroke:{}", self.frame)),
            (".grid".into(), format!("stroke:{}", self.grid)),
            (".minor".into(), format!("stroke:{}", self.minor)),
            (".floor".into(), format!("stroke:{}", self.muted)),
            (".ink".into(), format!("stroke:{}", self.text)),
            (".badge".into(), format!("fill:{}", self.text)),
            (".badge-text".into(), format!("fill:{}", self.background)),
            (".measured>*".into(), format!("stroke:{}", self.background)),
            (".rest>*".into(), format!("fill:{}", self.background)),
            (".halo".into(), format!("stroke:{}", self.background)),
            (".key".into(), format!("color:{}", self.muted)),
            (".model".into(), format!("color:{}", self.text)),
            (".shade".into(), format!("fill:{}", self.grid)),
            (".noise".into(), format!("fill:{}", self.frame)),
            (".invalid".into(), format!("fill:{}", self.series(1, 3))),
        ];
        rules.extend(
            (0..series).map(|i| (format!(".s{i}"), format!("color:{}", self.series(i, series)))),
        );
        rules.extend(
            self.sigma
                .iter()
                .enumerate()
                .map(|(i, colour)| (format!(".q{i}"), format!("fill:{colour}"))),
        );
        write(id, &rules)
    }
}

/// Rules that are the same in every scheme.
const SHAPES: &[(&str, &str)] = &[
    (
        "",
        "font-family:system-ui,-apple-system,'Segoe UI',Roboto,'Helvetica Neue',Arial,\
          'Liberation Sans',sans-serif",
    ),
    (".h", "font-weight:600"),
    (".b", "font-weight:600"),
    (".frame", "fill:none;stroke-width:1"),
    (".grid", "fill:none;stroke-width:1"),
    (".minor", "fill:none;stroke-width:1"),
    (".floor", "fill:none;stroke-width:1.2;stroke-dasharray:5 3"),
    (".ink", "fill:none;stroke-width:1.6;stroke-linecap:square"),
    (".halo", "fill:none;stroke-width:3.4;stroke-linecap:square"),
    (
        ".line",
        "fill:none;stroke:currentColor;stroke-width:1.7;stroke-linejoin:round;\
               stroke-linecap:round",
    ),
    (".thin", "fill:none;stroke:currentColor;stroke-width:1;stroke-dasharray:2 2.5"),
    (".broad", "fill:none;stroke:currentColor;stroke-width:6;opacity:.4;stroke-linejoin:round"),
    (".stem", "fill:none;stroke:currentColor;stroke-width:1;opacity:.35"),
    (".bar", "fill:none;stroke:currentColor;stroke-width:2.4"),
    (".band", "fill:currentColor;stroke:none;opacity:.22"),
    (".noise", "stroke:none;opacity:.3"),
    (".invalid", "stroke:none;opacity:.13"),
    (".measured", "fill:currentColor;stroke-width:.9"),
    (".dense", "fill:currentColor;stroke:none"),
    (".hollow>*", "fill:none;stroke:currentColor;stroke-width:.9;opacity:.7"),
    (".faint", "fill:none;stroke:currentColor;stroke-width:1;opacity:.55"),
    (".rest>*", "stroke:currentColor;stroke-width:1.2"),
    (".label", "fill:currentColor;font-weight:600"),
    (".fill", "fill:currentColor"),
    (".badge-text", "font-weight:700"),
];

fn write(id: &str, rules: &[(impl AsRef<str>, impl AsRef<str>)]) -> String {
    rules.iter().fold(String::new(), |mut text, (selector, declarations)| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "#{id} {}{{{}}}", selector.as_ref(), declarations.as_ref());
        text
    })
}

/// The style sheet of the figure with this id and so many series.
pub(super) fn stylesheet(theme: Theme, id: &str, series: usize) -> String {
    let shapes = write(id, SHAPES).replace(&format!("#{id} {{"), &format!("#{id}{{"));
    let [light, dark] = [LIGHT, DARK].map(|palette| palette.rules(id, series));
    // Shapes first: of two rules for a property, the later one counts.
    match theme {
        Theme::Light => format!("{shapes}{light}"),
        Theme::Dark => format!("{shapes}{dark}"),
        Theme::Auto => {
            format!("{shapes}{light}@media screen and (prefers-color-scheme:dark){{\n{dark}}}\n")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance (WCAG 2.2).
    fn luminance(colour: &str) -> f64 {
        let channel = |i: usize| {
            let value = f64::from(u8::from_str_radix(&colour[i..i + 2], 16).unwrap()) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
    }

    fn contrast(a: &str, b: &str) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    // WCAG 2.2: 4.5 for text (1.4.3), 3 for what must be seen in graphics (1.4.11).
    #[test]
    fn text_and_series_stand_out_from_the_background() {
        for palette in [LIGHT, DARK] {
            assert!(contrast(palette.text, palette.background) > 4.5);
            assert!(contrast(palette.muted, palette.background) > 4.5);
            for count in 1..9 {
                for index in 0..count {
                    let colour = palette.series(index, count);
                    assert!(contrast(&colour, palette.background) > 3.0, "{colour}");
                }
            }
        }
    }

    #[test]
    fn residual_classes_are_ordered_in_lightness_away_from_the_background() {
        for palette in [LIGHT, DARK] {
            let steps: Vec<f64> =
                palette.sigma.iter().map(|c| contrast(c, palette.background)).collect();
            assert!(steps.windows(2).all(|pair| pair[0] < pair[1]), "{steps:?}");
        }
    }

    #[test]
    fn a_size_that_is_half_given_keeps_the_proportions() {
        let size =
            |width, height| Format { width, height, ..Format::default() }.size([800.0, 600.0]);
        assert_eq!(size(None, None), [800.0, 600.0]);
        assert_eq!(size(Some(400), None), [400.0, 300.0]);
        assert_eq!(size(None, Some(300)), [400.0, 300.0]);
        assert_eq!(size(Some(400), Some(400)), [400.0, 400.0]);
    }

    #[test]
    fn an_unknown_theme_is_refused_with_those_known() {
        assert_eq!("dark".parse(), Ok(Theme::Dark));
        assert!("sepia".parse::<Theme>().unwrap_err().contains("auto, light, dark"));
    }
}
