// The looks of the report: phone and desktop, light and dark.
#pragma once

namespace vdna::report
{

constexpr const char *page_style = R"(
:root {
  color-scheme: light dark;
  --ink: #1c2127; --faint: #5b6570; --paper: #fff; --shade: #f2f4f7; --line: #d4d9df;
  --one: #ffdfad; --more: #ffc2bb; --bar: #5b8def;
}
@media (prefers-color-scheme: dark) {
  :root {
    --ink: #e6e9ed; --faint: #a0a9b4; --paper: #14171b; --shade: #1f242a; --line: #3a424c;
    --one: #6b4700; --more: #7a211b; --bar: #4f7fd8;
  }
}
* { box-sizing: border-box; }
body {
  margin: 0 auto; padding: 1rem; max-width: 76rem; overflow-wrap: anywhere;
  font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--paper);
}
h1 { font-size: 1.6rem; line-height: 1.25; margin: .5rem 0; }
h2 {
  font-size: 1.25rem; margin: 2.5rem 0 .5rem; padding-top: .75rem;
  border-top: 1px solid var(--line);
}
p { max-width: 46rem; margin: .5rem 0; }
.facts { color: var(--faint); }
.result {
  font-size: 1.15rem; padding: .75rem 1rem; background: var(--shade);
  border-left: 4px solid var(--bar);
}
.scroll {
  display: flex; overflow-x: auto; margin: 1rem 0; scrollbar-width: thin;
  scrollbar-color: var(--faint) var(--shade);
}
/* Fades out what goes on to the right; over the blank end of a table it is not seen. */
.scroll::after {
  content: ""; position: sticky; right: 0; flex: 0 0 2.5rem; pointer-events: none;
  background: linear-gradient(to right, transparent, var(--paper) 85%);
}
.scroll:focus-visible { outline: 2px solid var(--bar); outline-offset: 2px; }
table {
  border-collapse: collapse; font-size: .875rem; font-variant-numeric: tabular-nums;
  overflow-wrap: normal;
}
caption { text-align: left; font-weight: 600; padding: .25rem 0; }
caption span { display: inline-block; position: sticky; left: 0; max-width: calc(100vw - 2rem); }
th, td {
  padding: .3rem .7rem; text-align: left; white-space: nowrap;
  border-bottom: 1px solid var(--line);
}
thead th { border-bottom: 2px solid var(--line); vertical-align: bottom; }
tbody th { font-weight: 500; position: sticky; left: 0; background: var(--paper);
  box-shadow: 1px 0 var(--line); z-index: 1;
}
.number { text-align: right; }
small { color: var(--faint); font-weight: 400; }
.ours, .ours th { background: var(--shade); font-weight: 600; }
.one { background: var(--one); }
.more { background: var(--more); }
.legend span.one, .legend span.more { padding: .1rem .4rem; border-radius: .2rem; }
details { border: 1px solid var(--line); border-radius: .4rem; margin: .6rem 0; padding: 0 .8rem; }
summary { cursor: pointer; padding: .5rem 0; }
figure { margin: 0; }
figcaption { font-size: .875rem; color: var(--faint); }
figcaption b { color: var(--ink); }
.matrices, .matches, .examples { display: flex; flex-wrap: wrap; gap: 1rem; padding: .4rem 0 1rem; }
.panel { max-width: 100%; }
svg { display: block; width: 100%; height: auto; font-family: inherit; }
.charts {
  display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 20rem), 1fr));
  gap: 1.5rem; margin: 1rem 0;
}
.charts > * { min-width: 0; }
.charts svg { max-width: 34rem; }
.key svg, svg.bar { display: inline-block; width: .7em; }
svg.bar { width: 5rem; height: .6rem; margin-left: .6rem; }
.bar rect { fill: var(--bar); }
.against rect { fill: var(--wrong); }
.pair { display: flex; gap: 4px; }
.pair > * { width: 160px; max-width: calc(50% - 2px); height: auto; display: block; }
.matches figure, .examples figure { max-width: 324px; }
.matches figure { border-top: 3px solid #009e73; padding-top: 4px; }
.matches figure.wrong { border-top: 3px dashed #d55e00; }
.gone {
  padding: 1rem .5rem; font-size: .8rem; color: var(--faint); border: 1px dashed var(--line);
}
dl { display: grid; grid-template-columns: max-content 1fr; gap: .2rem 1rem; margin: .5rem 0; }
dt { color: var(--faint); }
dd { margin: 0; min-width: 0; }
)";

} // namespace vdna::report
