// SPDX-License-Identifier: GPL-3.0-or-later
#include "experiments/report/page/style.hpp"

namespace cinch {

const char* const page_style =
    R"css(:root { --ink: #1c2126; --soft: #5d6670; --line: #d9dde1; --wash: #f5f6f7; --link: #0b5c92;
  --same: #1a7346; --differs: #b4460f; --unknown: #6b7280;
  --paper: #fff; --mark: #fff3c4; --warn: #fdf3ec; --faint: #9aa1a8; }
@media (prefers-color-scheme: dark) { @media not print {
  :root { --ink: #e4e7ea; --soft: #a4adb6; --line: #3a4149; --wash: #20252b; --link: #7ab8e6;
    --same: #5fc392; --differs: #f0935f; --unknown: #a4adb6;
    --paper: #14181c; --mark: #4a4113; --warn: #33231a; --faint: #79828b; }
  figure.chart svg { background: #fff; border-radius: 4px; }
} }
* { box-sizing: border-box; }
html { color-scheme: light dark; scroll-behavior: smooth; -webkit-text-size-adjust: 100%; }
body { margin: 0; color: var(--ink); background: var(--paper);
  font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", "DejaVu Sans", sans-serif; }
main { max-width: 60rem; margin: 0 auto; padding: 2.5rem 1.25rem 5rem; }
h1 { font-size: 2rem; line-height: 1.2; letter-spacing: -.015em; margin: 0 0 .6rem; }
h2 { font-size: 1.35rem; line-height: 1.3; letter-spacing: -.01em; margin: 3.2rem 0 .8rem;
  padding-top: .8rem; border-top: 2px solid var(--ink); }
h3 { font-size: 1.05rem; margin: 2rem 0 .4rem; }
p { margin: .6rem 0; max-width: 44rem; }
.lead { font-size: 1.1rem; color: var(--soft); }
cite { font-style: italic; }
code { font: .86em/1.5 ui-monospace, SFMono-Regular, Menlo, Consolas, "DejaVu Sans Mono", monospace; }
nav { margin: 1.4rem 0; padding: .55rem 0; border-top: 1px solid var(--line); border-bottom: 1px solid var(--line); }
nav a { display: inline-block; margin-right: 1.1rem; color: var(--link); text-decoration: none; }
nav a:hover { text-decoration: underline; }
a.f { color: inherit; text-decoration: underline dotted #aab2ba 1px; text-underline-offset: .2em; }
a.f:hover, a.f:focus { color: var(--link); text-decoration: underline solid; }
.none { color: var(--faint); }
.damage, .missing { padding: .55rem .9rem; border-left: 4px solid var(--differs); background: var(--warn);
  max-width: none; overflow-wrap: anywhere; }
.missing { border-color: var(--unknown); background: var(--wash); }
.table { overflow-x: auto; margin: 1.2rem 0 1.6rem; }
table { border-collapse: collapse; font-size: .9rem; min-width: 60%; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: var(--soft); padding-bottom: .5rem; font-size: .92rem; }
th, td { padding: .28rem .75rem; text-align: right; vertical-align: baseline; }
th { font-weight: 600; border-bottom: 1px solid var(--ink); white-space: nowrap; }
th[colspan] { text-align: center; }
tbody { border-bottom: 1px solid var(--line); }
tbody tr:first-child td { padding-top: .6rem; }
td { color: var(--ink); }
td.l, th:first-child { text-align: left; }
td.l { white-space: nowrap; }
td.p { color: var(--soft); font-style: italic; }
tr.ratio td { color: var(--soft); font-size: .94em; padding-top: 0; padding-bottom: .45rem; }
tr.why td { text-align: left; padding: .3rem .75rem 1rem; max-width: 46rem; line-height: 1.5; }
strong.same { color: var(--same); } strong.differs { color: var(--differs); } strong.unknown { color: var(--unknown); }
.claims { list-style: none; margin: 1rem 0; padding: 0; }
.claims li { margin: 0 0 .9rem; padding: .15rem 0 .15rem 1rem; border-left: 4px solid var(--line); }
.claims li.same { border-color: var(--same); } .claims li.differs { border-color: var(--differs); }
.claims p { margin: .15rem 0; }
.claims .says { font-weight: 600; }
.claims cite { font-weight: 400; font-style: normal; color: var(--soft); font-size: .88em; white-space: nowrap; }
figure.chart { margin: 1.4rem 0 2rem; }
figure.chart > div { overflow-x: auto; }
figure.chart svg { display: block; width: 100%; min-width: 34rem; max-width: 50rem; height: auto; }
figcaption { color: var(--soft); font-size: .9rem; max-width: 44rem; }
.from { font-size: .9em; }
details { margin: .4rem 0; }
summary { cursor: pointer; }
.lines { margin: .4rem 0 1rem; padding-left: 3.6rem; color: var(--soft); }
.lines li { margin: .1rem 0; overflow-wrap: anywhere; }
.lines li:target { background: var(--mark); color: var(--ink); }
#provenance td { text-align: left; }
#provenance table { font-size: .84rem; }
#provenance td:nth-child(2) { min-width: 18rem; }
@media (max-width: 40rem) {
  main { padding: 1.4rem 1rem 3rem; }
  h1 { font-size: 1.55rem; }
  th, td { padding: .28rem .5rem; }
  tr.why td > div, caption > div { position: sticky; left: 0; width: calc(100vw - 3rem); }
}
@media print {
  @page { margin: 18mm 15mm; }
  body { font-size: 10pt; }
  main { max-width: none; padding: 0; }
  :root { color-scheme: light; }
  nav, #lines, .view-controls, .view-keys { display: none !important; }
  h2, h3 { break-after: avoid; }
  .view { break-inside: avoid; }
  figure.chart, tbody, .claims li { break-inside: avoid; }
  figure.chart svg { min-width: 0; max-width: 15cm; }
  .table { overflow: visible; }
  table { min-width: 0; font-size: 8pt; }
  th, td, td.l { padding: .15rem .4rem; white-space: normal; overflow-wrap: anywhere; min-width: 0; }
  #provenance table { font-size: 7pt; }
  #provenance td:nth-child(2) { min-width: 0; }
  a.f { text-decoration: none; }
}
)css";

// Opens the list that a link leads into.
const char* const page_script = R"js(function reveal() {
  const line = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  const list = line && line.closest('details');
  if (list) { list.open = true; line.scrollIntoView({block: 'center'}); }
}
addEventListener('hashchange', reveal);
reveal();
)js";

} // namespace cinch
