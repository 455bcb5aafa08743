# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
"""One page (HTML that needs nothing else) of a real walk beside the same walk simulated, paired by
query: maps with both answers, and success along the walk. See walk_trial.py."""
import html
import math

STYLE = '''
:root { --ink:#1d2733; --soft:#51606f; --rule:#d8dee5; --wash:#f5f7f9; --blue:#0072b2; --red:#d55e00;
  --paper:#fff; --line:#9aa7b4; }
@media screen and (prefers-color-scheme: dark) { :root { color-scheme:dark; --ink:#e3e8ed; --soft:#a9b4bf;
  --rule:#2f3841; --wash:#1c232a; --blue:#4aa8e0; --red:#f0884a; --paper:#14191f; --line:#5d6975; } }
* { box-sizing:border-box; }
body { margin:0 auto; padding:28px 28px 48px; max-width:1160px; color:var(--ink); background:var(--paper);
  font:16px/1.55 system-ui,-apple-system,"Segoe UI","Liberation Sans","DejaVu Sans",sans-serif; }
h1 { margin:0 0 6px; font-size:28px; line-height:1.25; }
h2 { margin:40px 0 4px; padding-top:12px; border-top:1px solid var(--rule); font-size:20px; }
p { margin:6px 0 10px; max-width:78ch; }
.soft { color:var(--soft); font-size:14px; }
.pair { display:grid; grid-template-columns:repeat(auto-fit,minmax(min(400px,100%),1fr)); gap:16px; }
figure { margin:0; } figcaption { font-size:14px; color:var(--soft); }
svg { width:100%; height:auto; display:block; background:var(--wash); border:1px solid var(--rule); }
svg text { fill:var(--soft); font-size:13px; }
.way { fill:none; stroke:var(--line); stroke-width:1.5; }
.node { fill:var(--paper); stroke:var(--line); stroke-width:1.2; }
.real { stroke:var(--red); fill:var(--red); } .sim { stroke:var(--blue); fill:var(--blue); }
.off { stroke-width:1.2; opacity:.75; }
.none { fill:none; stroke-width:1.6; }
.scroll { overflow-x:auto; }
table { border-collapse:collapse; font-size:14px; margin:10px 0; }
th,td { padding:4px 10px; border-bottom:1px solid var(--rule); text-align:right; }
td { white-space:nowrap; } th { vertical-align:bottom; font-weight:600; color:var(--soft); } th:first-child,td:first-child,.left { text-align:left; }
.out { color:var(--red); font-weight:600; }
@media (max-width:600px) { body { padding:18px 14px 36px; } th,td { padding:4px 6px; } }
'''


def number(value):
    return f'{value:.1f}'


class Plan:
    """A map of the walk in pixels, y up."""
    SIZE = 440

    def __init__(self, poses):
        xs, ys = [p[0] for p in poses], [p[1] for p in poses]
        self.low = min(xs) - 1, min(ys) - 1
        span = max(max(xs) - min(xs), max(ys) - min(ys)) + 2
        self.scale = self.SIZE / span
        self.height = (max(ys) - min(ys) + 2) * self.scale

    def at(self, x, y):
        return number((x - self.low[0]) * self.scale), number(self.height - (y - self.low[1]) * self.scale)

    def svg(self, comparison, answers, kind, label):
        poses = comparison.walk.poses
        parts = [f'<svg viewBox="0 0 {self.SIZE} {number(self.height)}" role="img" '
                 f'aria-label="{html.escape(label)}">']
        points = ' '.join(','.join(self.at(p[0], p[1])) for p in poses)
        parts.append(f'<polyline class="way" points="{points}"/>')
        for n in comparison.nodes:
            x, y = self.at(*poses[n][:2])
            parts.append(f'<circle class="node" cx="{x}" cy="{y}" r="2.6"/>')
        for i, answer in zip(comparison.queries, answers):
            x, y = self.at(*poses[i][:2])
            if answer['at'] is None:
                parts.append(f'<circle class="{kind} none" cx="{x}" cy="{y}" r="4.5">'
                             '<title>no answer</title></circle>')
                continue
            u, v = self.at(*answer['at'])
            parts.append(f'<line class="{kind} off" x1="{x}" y1="{y}" x2="{u}" y2="{v}"/>'
                         f'<circle class="{kind}" cx="{u}" cy="{v}" r="2.6"><title>off by '
                         f'{answer["off_m"]:.2f} m, {answer["turn_deg"]:.0f} deg</title></circle>')
        bar = self.scale
        y = number(self.height - 14)
        parts.append(f'<path class="way" d="M14 {y}h{number(bar)}"/><text x="{number(20 + bar)}" '
                     f'y="{number(self.height - 10)}">1 m</text></svg>')
        return ''.join(parts)


def strip(comparison, is_hit):
    """A column for each query along the walk: real above, share of the predictions below."""
    way = comparison.walk.way
    width, height = 1100, 76
    parts = [f'<svg viewBox="0 0 {width} {height}" role="img" aria-label="success along the walk">'
             '<text x="6" y="26">real</text><text x="6" y="56">predicted</text>']

    def column(metres):
        return 90 + (width - 110) * metres / way[-1]

    for k, i in enumerate(comparison.queries):
        x = number(column(way[i]))
        hit = is_hit(comparison.real[k])
        share = sum(is_hit(run[k]) for run in comparison.predicted) / len(comparison.predicted)
        parts.append(f'<rect class="real" x="{x}" y="12" width="4" height="18" '
                     f'fill-opacity="{1 if hit else 0}" stroke-width="1"/>')
        parts.append(f'<rect class="sim" x="{x}" y="42" width="4" height="18" fill-opacity="{share:.2f}" '
                     f'stroke-width="1"><title>{100 * share:.0f} % of the simulated walks</title></rect>')
    for metre in range(0, int(way[-1]) + 1, 5):
        parts.append(f'<text x="{number(column(metre))}" y="74">{metre} m</text>')
    return ''.join(parts) + '</svg>'


def table(figures):
    rows = ['<tr><th>nodes every</th><th class="left">method</th><th>within 1 m: real</th><th>predicted</th>'
            '<th>difference, points</th><th>within 0.25 m, 5°: real</th><th>predicted</th>'
            '<th>difference, points</th><th>median error: real</th><th>predicted</th><th>ratio</th></tr>']

    def success(s):
        mark = '' if s['holds_0'] else ' class="out"'
        return (f'<td>{100 * s["real"]:.0f} %</td><td>{100 * s["predicted"]:.0f} %</td><td{mark}>'
                f'{100 * s["difference"]:+.0f} [{100 * s["low"]:+.0f}, {100 * s["high"]:+.0f}]</td>')

    for f in figures:
        e = f['error']
        mark = '' if e['within'] else ' class="out"'
        ratio = '–' if math.isnan(e['ratio']) else f'{e["ratio"]:.2f} [{e["low"]:.2f}, {e["high"]:.2f}]'
        rows.append(f'<tr><td>{f["spacing_m"]:g} m</td><td class="left">{f["method"]}</td>{success(f["near"])}'
                    f'{success(f["exact"])}<td>{e["real_m"]:.3f} m</td><td>{e["predicted_m"]:.3f} m</td>'
                    f'<td{mark}>{ratio}</td></tr>')
    return f'<div class="scroll"><table>{"".join(rows)}</table></div>'


def page(compared, half, sources, draws, is_near):
    walk = compared[0].walk
    plan = Plan(walk.poses)
    said = html.escape(', '.join(sources)) or 'defaults'
    parts = [f'''<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1"><title>A walk, real and simulated</title>
<style>{STYLE}</style></head><body><h1>A walk, real and simulated</h1>
<p>{len(walk.views)} views of a walk of {walk.way[-1]:.1f} m; nodes every so many metres of it, the other views of the
{"whole" if half == "both" else half + " half"} as queries. <b style="color:var(--red)">Real</b>: lines found in its images.
<b style="color:var(--blue)">Predicted</b>: the same poses in a world built from its views, {draws} {"draw" if draws == 1 else "draws"}; sources: {said}.</p>
{table([c.figures() for c in compared])}
<p class="soft">Differences are real minus predicted, paired by query; intervals of 95 % by a bootstrap over blocks of 2 m.
Marked: an interval without 0, a ratio of medians outside of 0.67 to 1.5.</p>''']
    for c in compared:
        title = f'{c.method}, nodes every {c.spacing_m:g} m'
        real, predicted = c.real, c.predicted[0]
        parts.append(f'<h2>{title}</h2><div class="pair">')
        for answers, kind, name in ((real, 'real', 'real'), (predicted, 'sim', 'simulated, first draw')):
            near = sum(map(is_near, answers))
            parts.append(f'<figure>{plan.svg(c, answers, kind, f"{title}: {name}")}<figcaption>{name}: '
                         f'{near:.0f} of {len(answers)} queries within 1 m. A dot is an answer, a line leads to it '
                         'from the pose; a ring: no answer.</figcaption></figure>')
        parts.append(f'</div><p class="soft">Within 1 m, query by query along the walk (filled: yes; below: share of the '
                     f'draws).</p>{strip(c, is_near)}')
    return ''.join(parts) + '</body></html>\n'
