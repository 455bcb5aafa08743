// SPDX-FileCopyrightText: 2026 The Vernier authors
// SPDX-License-Identifier: Apache-2.0
import { chooser, element, paragraph, section } from "./elements.js";

const ERROR_COLOURS = [["#14a03c", "up to 0.5 px"], ["#e6c800", "up to 1 px"],
  ["#ff7800", "up to 3 px"], ["#dc1414", "above 3 px"], ["#1e5ae6", "no match"], ["#000000", "not"
    + " evaluated"]];

export function pictures_section(evaluation) {
  const scenes = evaluation.scenes.filter((scene) => scene.pictures);
  const made = section("pictures", "Pictures", paragraph(
    `Edges matched by ${scenes[0].pictures.matcher}, on the faded left image.`));
  const place = element("div", {});
  const show_scene = (i) => place.replaceChildren(...scene_pictures(scenes[i]));
  if (scenes.length > 1) {
    made.append(chooser("Pair", scenes.map((scene) => scene.name), 0, show_scene));
  }
  made.append(place);
  show_scene(0);
}

function scene_pictures(scene) {
  const { disparity, error, least_px, most_px } = scene.pictures;
  const key = ERROR_COLOURS.map(([colour, words]) => element("span", { class: "key" },
    element("span", { class: "swatch", style: `background:${colour}` }), words));
  return [
    element("figure", {}, element("h3", {}, "Disparity"),
      element("figcaption", {}, `Blue ${least_px} px to red ${most_px} px; grey: no match.`),
      element("img", { src: disparity, class: "picture",
        alt: `Edges of ${scene.name} coloured by disparity` })),
    element("figure", {}, element("h3", {}, "Error"), element("figcaption", {}, key),
      element("img", { src: error, class: "picture",
        alt: `Edges of ${scene.name} coloured by error` }))];
}
