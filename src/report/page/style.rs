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
.lead{font-size:1.1rem;line-height:1.5}
.verdict{display:flex;gap:.35rem 1rem;align-items:baseline;flex-wrap:wrap;padding:.55rem .9rem .6rem;
  background:var(--tint);border-left:.3rem solid var(--state)}
.verdict p{margin:0;max-width:none}
.verdict .word{font-size:.8rem;font-weight:700;letter-spacing:.05em;text-transform:uppercase;
  color:var(--state);white-space:nowrap}
.verdict .lead{flex:1 1 24rem;font-size:1.15rem;font-weight:600;line-height:1.35}
.good{--state:var(--good)}.part{--state:var(--part)}.bad{--state:var(--bad)}
.open{--state:var(--muted)}
/* The first screen: the response, and beside it what it comes to. */
.screen{display:grid;grid-template-columns:minmax(0,1fr) 22.5rem;gap:0 2rem;align-items:start;
  margin-top:.75rem}
.screen:not(:has(.first)){grid-template-columns:minmax(0,44rem)}
.screen .first{margin:0}
.screen .first .scroll,.screen .phone .scroll{margin:-.5rem 0 0 -1.4rem}
.screen .phone{display:none;margin:0}
.cards{display:flex;flex-direction:column;gap:.85rem}
.card{padding:0 0 .85rem;border-bottom:1px solid var(--grid)}
.card:last-child{border-bottom:0}
.card h2{padding:0;border:0;font-size:.78rem;font-weight:600;letter-spacing:.05em;
  text-transform:uppercase;color:var(--muted)}
.card.bad{padding:.7rem .9rem .8rem;border:0;border-left:.25rem solid var(--bad);background:var(--tint)}
.card.bad h2{color:var(--bad)}
.card p{margin:.3rem 0 0;font-size:.92rem;line-height:1.45}
.card .small{font-size:.84rem}
.card .name{display:flex;flex-wrap:wrap;gap:0 .6rem;align-items:baseline;margin-top:.1rem}
.card .name strong{font-size:1.2rem;font-weight:600;line-height:1.3}
.card .sure{color:var(--muted);font-size:.84rem}
.one+.one{margin-top:.8rem}
.values{margin:.35rem 0 0;font-size:.92rem;font-variant-numeric:tabular-nums}
.values div{display:flex;flex-wrap:wrap;justify-content:space-between;gap:0 1rem;padding:.1rem 0}
.values dt{font-size:inherit}
.values dd{margin-left:auto;text-align:right}
details{border-top:1px solid var(--grid)}
details:last-of-type{border-bottom:1px solid var(--grid)}
summary{display:flex;gap:.2rem 1rem;align-items:baseline;padding:.6rem .2rem;cursor:pointer;list-style:none}
summary::-webkit-details-marker{display:none}
summary::before{content:"";flex:none;width:.4rem;height:.4rem;border:solid var(--muted);
  border-width:0 .12rem .12rem 0;transform:rotate(-45deg) translateY(-.1rem)}
details[open]>summary::before{transform:rotate(45deg) translateY(-.1rem)}
summary:hover{background:var(--tint)}
summary h2{flex:none;width:13.5rem;padding:0;border:0;font-size:1rem}
summary .short{color:var(--muted);font-size:.92rem;line-height:1.4;min-width:0}
.card summary{flex-wrap:wrap;gap:0 .6rem;padding:0}
.card summary h2{flex:1;width:auto;font-size:.78rem}
.card summary .short{flex:0 0 100%;white-space:nowrap;overflow:hidden;text-overflow:ellipsis}
.card[open] summary .short{display:none}
.whole{padding:.2rem 0 1.75rem 1.6rem;max-width:55rem}
.whole>:first-child{margin-top:0}
dl,dd{margin:0}
dt{color:var(--muted);font-size:.9rem}
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
figure svg:focus-visible{outline:2px solid var(--good);outline-offset:-2px}
figure svg [data-toggle]:focus-visible{outline:2px solid var(--good)}
.tools-of-figure{display:flex;flex-wrap:wrap;gap:.3rem .5rem;align-items:center;margin:.1rem 0 0;
  color:var(--muted);font-size:.78rem;line-height:1.35}
.tools-of-figure span{flex:1 1 16rem}
.tools-of-figure button{padding:.15rem .55rem;font:inherit;color:var(--text);background:var(--back);
  border:1px solid var(--frame);border-radius:.25rem;cursor:pointer}
.tools-of-figure button:hover{background:var(--tint)}
.unseen{position:absolute;width:1px;height:1px;margin:0;overflow:hidden;clip-path:inset(50%);
  white-space:nowrap}
figcaption{margin-top:.25rem;max-width:44rem}
@media (max-width:62rem){
  .screen{grid-template-columns:minmax(0,1fr)}
  .cards{margin-top:.75rem;display:grid;grid-template-columns:repeat(auto-fit,minmax(17rem,1fr));gap:1rem 2rem}
  .card,.card:last-child{border-bottom:0;padding-bottom:0}
}
@media (max-width:40rem){
  summary{flex-wrap:wrap}
  summary h2{width:auto;flex:1}
  summary .short{flex-basis:100%;padding-left:1.4rem}
  .whole{padding-left:0}
  h1{font-size:1.5rem}
  .verdict .lead{font-size:1.05rem}
  .pairs div{grid-template-columns:1fr;gap:0}
  .scroll svg{flex:none;width:44rem}
  /* A figure that is wider than the screen says so at its edge. */
  figure .scroll{display:flex}
  figure .scroll::after{content:"›";position:sticky;right:0;flex:none;display:grid;place-items:center;
    width:1rem;color:var(--muted);background:var(--back);border-left:1px solid var(--grid)}
  figure .scroll{margin:0 -1rem}
  .screen .first{display:none}
  .screen .phone{display:block}
  .phone .scroll svg{width:100%}
  .phone .scroll::after{content:none}
  .w{min-width:14rem}
}
"#;

/// How a page is laid out on a screen and on paper.
const PAGE: &str = r#"
body{margin:0 auto;padding:1rem 1.5rem 4rem;max-width:84rem}
.title{display:flex;flex-wrap:wrap;gap:.1rem 1.25rem;align-items:baseline;margin-bottom:.6rem}
.title h1{font-size:1.3rem}
.title .origin{margin:0}
main>details:first-of-type{margin-top:1rem}
@media (max-width:40rem){body{padding:1rem 1rem 3rem}}
@media print{
  @page{size:A4;margin:17mm 11mm}
  html{font-size:9.5pt}
  body{max-width:none;padding:0 1rem}
  .screen{display:block}
  .cards{margin-top:4mm;display:grid;grid-template-columns:1fr 1fr;gap:4mm 8mm}
  .tools-of-figure{display:none}
  details::details-content{content-visibility:visible;block-size:auto}
  summary::before{display:none}
  h2,h3,caption,thead,summary{break-after:avoid}
  figure,tr,.verdict,.card,pre,.formula{break-inside:avoid}
  figure svg{max-height:225mm}
  .scroll{overflow:visible}
  a{color:inherit;text-decoration:none}
  .verdict,.card,pre{print-color-adjust:exact;-webkit-print-color-adjust:exact}
}
"#;
