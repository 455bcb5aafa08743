// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
//
// node page_test.mjs [--screenshots DIR] PAGE.html ...
//
// Opens report pages in Chromium as a reader would, from a file, and fails for any error on the
// console, any request, a missing section, a plot without traces, text such as NaN, or a page
// wider than its window. Checks the pages given, which the program wrote, and the first of them with
// other data put in: samples with plots, without plotly, with hardly any data, with gaps. Needs
// `npm ci` in tests/cli; exit code 77 without.
import fs from "node:fs";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const here = path.dirname(fileURLToPath(import.meta.url));
const require = createRequire(path.join(here, "package.json"));

/** A page that the program wrote, with other data (JSON text), or without plotly's script. */
function with_data(page, report, { plotly }) {
  const data = report.replaceAll("<", "\\u003c");
  const other = page.replace(/(<script [^>]*id="data">)[^<]*/, (_, tag) => tag + data);
  return plotly ? other : other.replace(/<script id="plotly">[^]*?<\/script>/, "");
}

/** Pages to check: file, and whether it must have plots. */
function sample_pages(folder, page) {
  const sample = fs.readFileSync(path.join(here, "report_sample.json"), "utf8");
  const full = JSON.parse(sample);
  const study = full.study;
  const made = {
    "sample": [sample, true],
    "sample-without-plotly": [sample, false],
    "title-only": [JSON.stringify({ title: "Only a </script><b>title</b>" }), true],
    "bare-rig": [JSON.stringify({ title: "A rig", rigs: [bare_rig(full.rigs[0])] }), true],
    "one-rig": [JSON.stringify({ title: "A calibration", rigs: [full.rigs[0]] }), true],
    "odd-rigs": [JSON.stringify({ title: "Odd", rigs: odd_rigs(full.rigs[0]) }), true],
    "one-cell": [JSON.stringify({ ...full, view: undefined, rigs: [], study: { ...study,
      sweep: null, world_ceiling: null, comparisons: [],
      cells: [bare_cell(study.cells[2])] } }), true],
    "no-sweep": [JSON.stringify({ title: "Methods", study: { ...study, sweep: null } }), true],
    ...gap_samples(study),
    "adjusted": [JSON.stringify({ title: "Adjusted", study: adjusted(study) }), true],
    "true-bound": [JSON.stringify({ title: "Bound", rigs: [true_bound(full.rigs[0])] }), true],
    "reliability": [JSON.stringify({ title: "Reliability", study: with_reliability(study) }), true],
    "two-keys": [JSON.stringify({ title: "Two keys", study: swept_by(study, 2) }), true],
    "three-keys": [JSON.stringify({ title: "Three keys", study: swept_by(study, 3) }), true],
    "one-at-a-time": [JSON.stringify({ title: "Designs", study: designed(study) }), true],
    "several-studies": [JSON.stringify({ ...full, study: undefined, world: undefined, view: undefined,
      studies: ["a", "b"].map((name) => ({ name, study: swept_by(study, 1), world: full.world,
        view: full.view })) }), true],
    "sweep-with-zero": [JSON.stringify({ title: "Zero", study: with_zero(study) }), true],
  };
  return Object.entries(made).map(([name, [report, plotly]]) => {
    const file = path.join(folder, `${name}.html`);
    fs.writeFileSync(file, with_data(page, report, { plotly }));
    return { file, plotly };
  });
}

/** As of a rig file without evidence. */
const bare_rig = ({ corners, projection, view_influence, proof, ...rig }) => ({ ...rig,
  sigma_mvb: null, kind: "mvb", calibration: null, values: rig.values.map(() => null),
  missing: "no evidence" });

/** Rigs with what seldom happens: nothing proved, holes in a map, a view that decides alone. */
function odd_rigs(rig) {
  const holes = { ...rig.projection, cameras: rig.projection.cameras.map((one) => ({ ...one,
    maps: one.maps.map((map) => ({ ...map, sd_px: map.sd_px.map((row, y) =>
      y < 2 ? row.map(() => null) : row) })) })) };
  const alone = rig.view_influence.map((view, i) => i ? view
    : { ...view, images: [], influence_left_out: null, largest_share: 1 });
  const many = Array.from({ length: 200 }, (_, frame) => ({ frame, images: [],
    ...rig.view_influence[frame % rig.view_influence.length] }));
  const corners = rig.corners.map((one) => ({ ...one, outliers: [[20, 30, 41.5, 3, 7]],
    points: one.points.slice(0, 50) }));
  return [
    { ...rig, corners, view_influence: many,
      proof: { notes: ["Lens models were not compared: <b>why</b>."] } },
    { ...rig, file: "odd.rig.json", projection: holes, view_influence: alone, proof: undefined,
      calibration: { ...rig.calibration, doubts: ["residuals of 1.2 px"], prior_dof: 2,
        prior_chi2: 1.5, held: ["left.ax"], warp_m: [1e-3, -2e-4] } },
  ];
}

const bare_cell = (cell) => ({ ...cell, success_interval_95: null, median_error_m: null,
  cpu_ms_p95: null, world_ceiling: null });

/** As of the shipped rig: its views scatter as the white noise does that the bound speaks of. */
const true_bound = (rig) => ({ ...rig, kind: "mvb", true_bound: true, sigma_mvb: rig.sigma });

/** Pages with null where there is nothing to tell: a gap of a plot and a dash of a table, not 0. */
function gap_samples(study) {
  const cells = study.cells.map((cell, i) => i !== 1 ? cell : { ...cell, success: null,
    success_interval_95: null, success_interval_binomial_95: null, median_error_m: null });
  return {
    "gap-in-study": [JSON.stringify({ title: "Gap", study: { ...study, cells } }), true],
    "gap-in-evaluation": [JSON.stringify({ title: "Gap", evaluation: evaluation_with_gaps() }), true],
  };
}

/** Two matchers on two pairs; "none" finds nothing where "some" does. */
function evaluation_with_gaps() {
  const figures = (bad) => ({ density: bad === null ? 0 : 0.9, bad_0_5: bad, bad_1: bad, bad_2: bad,
    mismatch: bad, rms_inlier_px: bad, bias_inlier_px: bad, bad_1_discontinuity: bad,
    coverage_95: null, time_ms: 12 });
  const by_angle = (bad) => Array.from({ length: 9 }, (_, i) => ({ from_deg: 10 * i,
    to_deg: 10 * i + 10, edges: i ? 100 : 0, density: i ? 0.9 : null,
    bad_1: i === 4 ? null : bad, rms_inlier_px: i === 5 ? null : 0.2 }));
  const matchers = { some: figures(0.05), none: figures(null) };
  const scene = (name) => ({ name, left: `${name}.png`, matchers: {
    some: { ...matchers.some, by_angle: by_angle(0.05) },
    none: { ...matchers.none, by_angle: by_angle(0.1) } } });
  const cell = (psi_c, mismatch) => ({ psi_c, rows_moved_px: 0, repair: false, repaired: 0, pairs: 2,
    rows_rms_px: psi_c, geometric_bias_rms_px: null, matchers: {
      some: { density: 0.9, bad_1: 0.1, mismatch, mismatch_interval_95: mismatch && [0.01, 0.2],
        disparity_error_rms_px: 1 },
      none: { density: 0, bad_1: null, mismatch: 0.5, mismatch_interval_95: null,
        disparity_error_rms_px: null } } });
  return { matchers, scenes: [scene("one"), scene("two")], outline: "either", doubts: [],
    settings: { command: "vernier evaluate --scenes 'two pairs.toml'", repair: false },
    curves: { some: [[0.5, 0.01], [0.7, null], [0.9, 0.05]], none: [[0.4, 0.1], [0.6, 0.2]] },
    calibration_error: { draws: 2, seed: 1, rigs: ["nominal"],
      cells: [cell(0.1, 0.02), cell(1, null), cell(10, 0.1)] } };
}

/** Four p below 0.05, of which Holm leaves two, and one that there are too few maps for. */
function adjusted(study) {
  const p = [[0.04, 0.06], [0.0123, 0.0369], [0.03, 0.06], [0.0011, 0.0044], [null, null]];
  const [row] = study.comparisons;
  return { ...study, comparisons: p.map(([p_value, p_value_holm]) => ({ ...row,
    test: "paired t over maps", p_value, p_value_holm })) };
}

/** One cell states probabilities; a range of them has no wrong answer. */
function with_reliability(study) {
  const bin = (stated_error, wrong, answers, interval) => ({ stated_error, wrong, answers,
    error: wrong / answers, error_interval_95: interval });
  const reliability = [bin(0.0001, 0, 700, [0, 0.0053]), bin(0.004, 1, 120, [0.0002, 0.0456]),
    bin(0.3, 22, 80, [0.182, 0.3866])];
  const thresholds = [[1, 900, 23], [0.1, 820, 1], [0.001, 700, 0]].map(
    ([max_error_rate, answered, wrong]) =>
      ({ max_error_rate, answered, wrong, coverage: answered / 900 }));
  return { ...study, cells: study.cells.map((cell, i) =>
    i ? cell : { ...cell, reliability, thresholds }) };
}

/** Cells of a grid of up to three keys. */
function swept_by(study, keys) {
  const grid = [["sources.calibration", [0.1, 1, 10]], ["localiser.method", ["lines", "pgh", "corners"]],
    ["study.protocol", ["near_path", "anywhere"]]].slice(0, keys);
  let all = [{}];
  for (const [key, values] of grid) {
    all = all.flatMap((one) => values.map((value) => ({ ...one, [key]: value })));
  }
  const cells = all.map((swept, i) => ({ ...study.cells[i % study.cells.length], swept,
    label: Object.entries(swept).map(([key, value]) => `${key} = ${value}`).join(", "),
    settings: { ...study.cells[0].settings, ...swept }, trial_list: undefined }));
  return { ...study, cells, comparisons: [], sweep: null,
    swept_keys: grid.map(([key]) => ({ key, label: key })) };
}

/** Cells of one source at a time. */
function designed(study) {
  const rows = [["as set", "", ""], ["no source", "", ""], ["only", "edge_loss", 0.1],
    ["all but", "stereo_mismatch_of_a_long_name", 0], ["swept", "edge_loss", 0.2]];
  const cells = rows.map(([design, source, value], i) => ({ ...study.cells[i % 3],
    swept: { design, source, value }, label: `${design} ${source} = ${value}`, trial_list: undefined }));
  return { ...study, cells, comparisons: [], sweep: null,
    swept_keys: ["design", "source", "value"].map((key) => ({ key, label: key })) };
}

function with_zero(study) {
  const cells = study.cells.map((cell, i) => i ? cell
    : { ...cell, label: "ψ_c = 0", settings: { ...cell.settings, "sources.calibration": 0 } });
  return { ...study, cells };
}

// Runs in the page.
function inspect() {
  const report = JSON.parse(document.getElementById("data").textContent);
  const of_study = ({ study }, end) => {
    const cells = study?.cells ?? [];
    return [
      [cells.length, `headline${end}`], [cells.length > 1, `sweep${end}`], [cells.length, `cells${end}`],
      [cells.some((cell) => cell.reliability?.length), `reliability${end}`],
      [cells.length && study.comparisons?.length, `comparisons${end}`]];
  };
  const of_map = ({ study, world, view }, end) => [
    [world || study?.cells.some((cell) => cell.trial_list?.length), `plan${end}`],
    [view, `view${end}`]];
  const of_studies = (report.studies ?? []).flatMap((one, i) =>
    [[true, `study-${i + 1}`], ...of_study(one, `-${i + 1}`), ...of_map(one, `-${i + 1}`)]);
  const rig_sections = (rig, id) => [[true, id], [rig.corners, `${id}-corners`],
    [rig.projection || rig.depth?.length, `${id}-projection`],
    [rig.view_influence, `${id}-views`], [rig.proof, `${id}-proof`]];
  const { evaluation } = report;
  const wanted = [
    [report.studies, "studies"], ...of_studies, ...of_study(report, ""),
    [evaluation, "scores"], [evaluation?.curves, "density"],
    [evaluation?.scenes[0]?.matchers && typeof window.Plotly !== "undefined", "angles"],
    [evaluation?.calibration_error, "calibration-error"],
    [evaluation?.scenes.some((scene) => scene.pictures), "pictures"],
    ...of_map(report, ""), [report.rigs?.length > 1, "calibrations"],
    ...(report.rigs ?? []).flatMap((rig, i) => rig_sections(rig, i ? `rig-${i + 1}` : "rig")),
    [report.program || report.study || report.studies || evaluation, "making"],
  ].filter(([needed]) => needed).map(([, id]) => id);
  const drawn = (place) => {
    const traces = [...place.querySelectorAll(".scatterlayer .trace, .heatmaplayer .hm,"
      + " .barlayer .trace, .contourlayer .contour")];
    return traces.length >= place.data.length && place.data.length > 0
      && traces.every((trace) => trace.querySelector("path[d], image"));
  };
  const plots = [...document.querySelectorAll("div.plot")];
  document.querySelectorAll("details").forEach((closed) => { closed.open = true; });
  const svg_text = [...document.querySelectorAll("svg text")].map((text) => text.textContent);
  return {
    missing: wanted.filter((id) => !document.querySelector(`#${id} h2`)?.textContent.trim()),
    order: [...document.querySelectorAll("main > section")].map((one) => one.id).join() ===
      wanted.join(),
    plots: plots.length,
    empty: plots.filter((place) => !place.data || !drawn(place))
      .map((place) => place.getAttribute("aria-label")),
    unnamed: plots.filter((place) => !place.getAttribute("aria-label")).length,
    turned: [...document.querySelectorAll("[id^=sweep] .xtick text, [id^=sweep] .ytick text,"
      + " #studies .xtick text, #studies .ytick text")]
      .filter((text) => /rotate\((?!0)/.test(text.getAttribute("transform") ?? "")).length,
    text: [document.title, document.body.innerText, ...svg_text].join("\n"),
    too_wide: document.documentElement.scrollWidth - window.innerWidth,
    notice: document.body.innerText.includes("This page has no plots"),
    nulls: plots.map((place) => (place.data ?? []).map((trace) =>
      (trace.y ?? []).filter((y) => y === null).length)),
    zero_shares: [...document.querySelectorAll("td")]
      .filter((cell) => /^0\.0+\s%/.test(cell.innerText)).length,
    heads: [...document.querySelectorAll("#rig thead th, #rig-proof td.text")]
      .map((head) => head.innerText),
  };
}

/** Runs in the page: text too faint on its ground (below 4.5 to 1), and sections without height. */
function inspect_medium() {
  const channels = (colour) => (colour.match(/[\d.]+/g) ?? []).map(Number);
  const luminance = ([r = NaN, g = NaN, b = NaN]) => [r, g, b].map((v) => v / 255)
    .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
    .reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const ground = (element) => {
    const bar = element.closest(".bars .point")?.querySelector("path");
    if (bar) return luminance(channels(getComputedStyle(bar).fill));
    for (let at = element; at; at = at.parentElement) {
      const colour = channels(getComputedStyle(at).backgroundColor);
      if (colour.length === 3 || colour[3] === 1) return luminance(colour);
    }
    return 1;
  };
  const faint = [...document.querySelectorAll("h1, h2, h3, p, td, th, li, svg.main-svg text, button")]
    .filter((one) => one.textContent.trim() && one.getClientRects().length)
    .filter((one) => {
      const style = getComputedStyle(one);
      const text = luminance(channels(one instanceof SVGElement ? style.fill : style.color));
      const [low, high] = [text, ground(one)].sort((a, b) => a - b);
      return !((high + 0.05) / (low + 0.05) >= 4.5);  // also what is no colour
    });
  return {
    faint: faint.length && `${faint.length} texts, as "${faint[0].textContent.trim().slice(0, 40)}"`,
    ground: ground(document.body),
    hidden: [...document.querySelectorAll("main > section")].filter((one) => !one.offsetHeight)
      .map((one) => one.id),
    too_wide: document.documentElement.scrollWidth - window.innerWidth,
  };
}

/** The page in the dark, and printed. */
async function faults_of_media(page, picture) {
  const faults = [];
  for (const [name, media] of [["light", { colorScheme: "light" }], ["dark", { colorScheme: "dark" }],
    ["print", { media: "print", colorScheme: "light" }]]) {
    await page.emulateMedia(media);
    let seen;
    for (let waits = 0; waits < 40; waits += 1) {  // until the plots are drawn again
      await page.waitForTimeout(250);
      seen = await page.evaluate(inspect_medium);
      if (!seen.faint) break;
    }
    if (seen.faint) faults.push(`${name}: too faint: ${seen.faint}`);
    if ((name === "dark") !== (seen.ground < 0.1)) faults.push(`${name}: its ground is ${seen.ground}`);
    if (seen.hidden.length) faults.push(`${name}: sections without height: ${seen.hidden}`);
    if (seen.too_wide > 0) faults.push(`${name}: ${seen.too_wide} px wider than its window`);
    if (picture) await page.screenshot({ path: picture(name), fullPage: true });
  }
  await page.emulateMedia({ media: null, colorScheme: null });
  return faults;
}

/** Opens a page at the first of the widths, and resizes it to the others. */
async function check_page(browser, one, widths, screenshots) {
  const { file } = one;
  const all = [];
  let faults = [];
  const address = pathToFileURL(path.resolve(file)).href;
  const page = await browser.newPage({ viewport: { width: widths[0], height: 900 } });
  page.on("console", (m) => ["error", "warning"].includes(m.type()) && faults.push(m.text()));
  page.on("pageerror", (error) => faults.push(`error: ${error.message}`));
  page.on("request", (request) => {
    const url = request.url();
    if (url !== address && !/^(data|blob):/.test(url)) faults.push(`request of ${url}`);
  });
  await page.goto(address, { waitUntil: "load", timeout: 120_000 });
  for (const width of widths) {
    await page.setViewportSize({ width, height: 900 });
    await page.waitForTimeout(300);
    const seen = await page.evaluate(inspect);
    faults.push(...faults_of(one, seen));
    if (one.plotly) faults.push(...await choose_another_cell(page));
    if (one.media && width > 1000) {
      faults.push(...await faults_of_media(page, screenshots
        && ((name) => path.join(screenshots, `${path.basename(file, ".html")}-${width}-${name}.png`))));
    }
    if (screenshots) {
      const picture = path.join(screenshots, `${path.basename(file, ".html")}-${width}.png`);
      await page.screenshot({ path: picture, fullPage: true });
    }
    all.push({ width, faults, plots: seen.plots });
    faults = [];
  }
  await page.close();
  return all;
}

function faults_of({ file, plotly }, seen) {
  const faults = seen.missing.map((id) => `section ${id} has no heading`);
  faults.push(...seen.empty.map((name) => `nothing drawn in "${name}"`));
  if (!seen.order) faults.push("sections are not in their order");
  if (seen.unnamed) faults.push(`${seen.unnamed} plots have no spoken name`);
  if (!plotly && seen.plots) faults.push("a plot without plotly");
  if (seen.notice === plotly) faults.push(`notice of missing plots: ${seen.notice}`);
  if (seen.turned) faults.push(`${seen.turned} labels of axes are turned`);
  if (seen.too_wide > 0) faults.push(`page is ${seen.too_wide} px wider than its window`);
  for (const match of seen.text.matchAll(/^.*\b(NaN|undefined|null|Infinity|\[object)\b.*$/gm)) {
    faults.push(`text "${match[0].trim().slice(0, 100)}"`);
  }
  faults.push(...(SPECIAL[path.basename(file, ".html")]?.(seen) ?? []).filter(Boolean));
  return faults;
}

/** What only one of the samples shows. */
const SPECIAL = {
  "gap-in-study": ({ nulls }) => [nulls[0]?.[0] !== 1 && "null success is no gap",
    nulls[1]?.[0] !== 1 && "null error is no gap"],
  "gap-in-evaluation": ({ nulls, zero_shares, text }) => [
    JSON.stringify(nulls[0]) !== "[1,0]" && "null error at a density is no gap",
    JSON.stringify(nulls[1]) !== "[2,2]" && "null errors at an angle are no gap",
    JSON.stringify(nulls[2]) !== "[3,3]" && "null precision at an angle is no gap",
    nulls[3]?.[0] !== 1 && "null mismatch is no gap",
    zero_shares !== 6 && `${zero_shares} shares of 0 in tables, where 6 densities are`,
    !text.includes("vernier evaluate --scenes 'two pairs.toml'") && "the command is not said"],
  "adjusted": ({ text }) => [
    !(text.includes("0.037") && text.includes("0.060")) && "an adjusted p is not shown",
    [...text.matchAll(/is\sbetter/g)].length !== 2 && "the words are not by the adjusted p",
    [...text.matchAll(/no\ssignificant\sdifference/g)].length !== 2 && "a p is not adjusted"],
  "true-bound": ({ heads, text }) => [
    heads.some((head) => head.includes("of the bound")) && "the bound stands twice in the table",
    heads.includes("honest") && "boards left out are counted twice",
    /too small|too sure/.test(text) && "a bound that holds is called too small",
    !text.includes("here it holds") && "a bound that holds is not called so"],
};

/** Another cell must change the plan. */
async function choose_another_cell(page) {
  const button = page.locator("#plan .chooser button[aria-pressed=false]").last();
  if (!await button.count()) return [];
  const points = () => page.evaluate(() =>
    JSON.stringify(document.querySelector("#plan div.plot").data.map((trace) => trace.x)));
  const before = await points();
  const chosen = page.locator("#plan .chooser button[aria-pressed=true]");
  const name = await chosen.textContent();
  await button.click();
  const same = await points() === before;
  await page.locator("#plan .chooser button", { hasText: name }).first().click();
  return same ? ["choosing another cell leaves the plan as it is"] : [];
}

function arguments_of(words) {
  const at = words.indexOf("--screenshots");
  const screenshots = at < 0 ? null : words.splice(at, 2)[1];
  return { screenshots, files: words };
}

/** Pages from the program have plots where they carry plotly. */
function given_page(file) {
  return { file, media: true,
    plotly: fs.readFileSync(file, "utf8").includes('<script id="plotly">') };
}

async function main() {
  let chromium;
  try {
    ({ chromium } = require("playwright-core"));
  } catch {
    console.log("skipped: run npm ci in tests/cli");
    return 77;
  }
  const { screenshots, files } = arguments_of(process.argv.slice(2));
  if (!files.length) throw new Error("give a page that vernier report wrote");
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), "vernier-page-"));
  const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: ["--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
      "--disable-background-networking", "--disable-component-update", "--disable-sync"],
  });
  let failed = 0;
  try {
    const samples = sample_pages(folder, fs.readFileSync(files[0], "utf8"));
    // What the program wrote is opened in both widths, as readers do; samples are resized.
    const visits = [...samples.map((one) => [one, [1280, 400]]),
      ...files.map(given_page).flatMap((one) => [[one, [1280]], [one, [400]]])];
    for (const [one, widths] of visits) {
      for (const { width, faults, plots } of await check_page(browser, one, widths, screenshots)) {
        console.log(`${faults.length ? "FAIL" : "ok"} ${path.basename(one.file)} at ${width} px, `
          + `${plots} plots`);
        faults.forEach((fault) => console.log(`     ${fault}`));
        failed += faults.length > 0;
      }
    }
  } finally {
    await browser.close();
    fs.rmSync(folder, { recursive: true });
  }
  return failed ? 1 : 0;
}

process.exitCode = await main();
