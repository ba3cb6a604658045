//! The style sheet: one typeface, one measure, and the colours of the figures.

use std::fmt::Write as _;

use crate::report::figures::{DARK, LIGHT, Palette};

/// The style sheet of a page in both colour schemes; paper is always light.
pub(super) fn sheet() -> String {
    format!("{}@media screen and (prefers-color-scheme:dark){{\n{}}}\n{PAGE}", shared(), dark())
}

/// Light colours, type, and what texts, tables and figures look like, for whatever
/// shows parts of a page.
pub fn shared() -> String {
    format!(":root{{color-scheme:light;{}}}\n{SHARED}", variables(&LIGHT))
}

/// The colours of the dark scheme, in place of the light ones.
pub fn dark() -> String {
    format!(":root{{color-scheme:dark;{}}}\n", variables(&DARK))
}

/// The colours as variables.
fn variables(palette: &Palette) -> String {
    let colours = [
        ("back", palette.background.to_owned()),
        ("text", palette.text.to_owned()),
        ("muted", palette.muted.to_owned()),
        ("frame", palette.frame.to_owned()),
        ("grid", palette.grid.to_owned()),
        ("tint", palette.minor.to_owned()),
        ("part", palette.series(0, 3)),
        ("bad", palette.series(1, 3)),
        ("good", palette.series(2, 3)),
    ];
    colours.iter().fold(String::new(), |mut text, (name, colour)| {
        // Writing to a string cannot fail.
        let _ = write!(text, "--{name}:{colour};");
        text
    })
}

const SHARED: &str = r#"
*{box-sizing:border-box}
html{scroll-behavior:smooth;-webkit-text-size-adjust:100%;text-size-adjust:100%}
body{margin:0;background:var(--back);color:var(--text);font:1rem/1.55 system-ui,-apple-system,
  'Segoe UI',Roboto,'Helvetica Neue',Arial,'Liberation Sans',sans-serif;overflow-wrap:break-word}
h1,h2,h3{line-height:1.25;font-weight:600;margin:0;text-wrap:balance}
h1{font-size:1.9rem;letter-spacing:-.01em}
h2{font-size:1.4rem;padding-top:1.25rem;border-top:1px solid var(--grid)}
h3{font-size:1.05rem;margin-top:1.75rem}
p,ul{margin:.75rem 0 0;max-width:44rem}
ul{padding-left:1.25rem}
li+li{margin-top:.35rem}
a{color:var(--good);text-underline-offset:.2em}
code{font:.82em ui-monospace,'SF Mono',Menlo,Consolas,'Liberation Mono',monospace;
  color:var(--muted);font-style:normal}
pre{margin:.75rem 0 0;padding:.75rem 1rem;background:var(--tint);overflow-x:auto;
  font:.82rem/1.5 ui-monospace,'SF Mono',Menlo,Consolas,'Liberation Mono',monospace}
section{margin-top:3rem;scroll-margin-top:1rem}
article+article{margin-top:2.25rem;padding-top:.25rem;border-top:1px solid var(--grid)}
.origin,.small,figcaption,caption{color:var(--muted);font-size:.9rem}
.origin{margin-top:.4rem}
.lead{font-size:1.1rem;line-height:1.5}
.verdict{margin-top:1.75rem;padding:1rem 1.25rem 1.1rem;background:var(--tint);
  border-left:.3rem solid var(--state)}
.verdict p{margin:.35rem 0 0}
.verdict .word{margin:0;font-size:.85rem;font-weight:600;letter-spacing:.04em;
  color:var(--muted)}
.verdict .lead{font-size:1.25rem;font-weight:600;line-height:1.4}
.good{--state:var(--good)}.part{--state:var(--part)}.bad{--state:var(--bad)}
.open{--state:var(--frame)}
dl,dd{margin:0}
dt{color:var(--muted);font-size:.9rem}
.facts{display:flex;flex-wrap:wrap;gap:1rem 2.5rem;margin-top:1.5rem}
.facts div{display:flex;flex-direction:column-reverse;justify-content:flex-end}
.facts dd{font-size:1.35rem;line-height:1.3;font-variant-numeric:tabular-nums}
.facts dt{max-width:15rem}
.pairs{margin-top:1rem}
.pairs div{display:grid;grid-template-columns:11rem 1fr;gap:1rem;padding:.35rem 0;
  border-bottom:1px solid var(--grid)}
.digest{overflow-wrap:anywhere}
.scroll{overflow-x:auto}
table{border-collapse:collapse;margin-top:1rem;font-size:.9rem;line-height:1.4;
  font-variant-numeric:tabular-nums}
caption{text-align:left;padding-bottom:.4rem}
th,td{padding:.35rem 1.25rem .35rem 0;text-align:left;vertical-align:top}
th:last-child,td:last-child{padding-right:0}
th{font-weight:400}
thead th{color:var(--muted);vertical-align:bottom;white-space:nowrap;
  border-bottom:1px solid var(--frame)}
tbody th,tbody td{border-bottom:1px solid var(--grid)}
.n{text-align:right;white-space:nowrap}
td[data-pad]::after{content:attr(data-pad);visibility:hidden}
.columns{display:flex;flex-wrap:wrap;gap:0 3.5rem;align-items:flex-start}
.symbol{white-space:nowrap}
.equation{font-style:italic}
sub,sup{line-height:0;font-size:.72em}
.formula{font-size:1.15rem}
.fraction{display:inline-flex;flex-direction:column;vertical-align:middle;text-align:center}
.fraction span{padding:.1rem .6rem}
.fraction span+span{border-top:1px solid var(--text)}
figure{margin:1.75rem 0 0}
figure svg{display:block;width:100%;height:auto}
/* A figure has a margin of its own: its content stands where the text does. */
figure .scroll{margin:0 -1.5rem}
figcaption{margin-top:.25rem;max-width:44rem}
main{counter-reset:figure}
figure{counter-increment:figure}
figcaption::before{content:"Figure " counter(figure) ". ";font-weight:600}
@media (max-width:40rem){
  h1{font-size:1.5rem}
  .verdict .lead{font-size:1.1rem}
  .pairs div{grid-template-columns:1fr;gap:0}
  .scroll svg{width:44rem}
  figure .scroll{margin:0 -1rem}
  .w{min-width:14rem}
}
"#;

/// How a page is laid out on a screen and on paper.
const PAGE: &str = r#"
body{margin:0 auto;padding:2.5rem 1.5rem 5rem;max-width:53rem}
nav{margin-top:2.25rem;font-size:.9rem}
nav ol{margin:0;padding:0;list-style:none;display:flex;flex-wrap:wrap;gap:.3rem 1.4rem}
@media (min-width:75rem){
  body{max-width:72rem;display:grid;grid-template-columns:13rem minmax(0,50rem);
    grid-template-rows:auto 1fr;column-gap:4rem;justify-content:center}
  header,main{grid-column:2}
  nav{grid-column:1;grid-row:1/3;margin-top:.6rem;position:sticky;top:2.5rem;align-self:start}
  nav ol{flex-direction:column;gap:.55rem}
  nav a{color:var(--muted);text-decoration:none}
  nav a:hover{color:var(--text);text-decoration:underline}
}
@media (max-width:40rem){body{padding:1.5rem 1rem 3rem}}
@media print{
  @page{size:A4;margin:17mm 11mm}
  html{font-size:10pt}
  body{max-width:none;padding:0 1.5rem;display:block}
  nav{display:none}
  section{margin-top:8mm}
  h2,h3,caption,thead{break-after:avoid}
  figure,tr,.verdict,.facts,pre,.formula{break-inside:avoid}
  figure svg{max-height:225mm}
  .scroll{overflow:visible}
  a{color:inherit;text-decoration:none}
  .verdict,pre{print-color-adjust:exact;-webkit-print-color-adjust:exact}
}
"#;
