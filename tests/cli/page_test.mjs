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

import { sample_pages } from "./page_samples.mjs";
import { faults_of_systems, inspect_systems } from "./page_systems.mjs";

const here = path.dirname(fileURLToPath(import.meta.url));
const require = createRequire(path.join(here, "package.json"));

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
    faults.push(...faults_of_systems(await page.evaluate(inspect_systems), one));
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
