/**
 * Colours that people with any colour vision tell apart: Okabe and Ito, "Color Universal Design" (2008),
 * lightened or darkened where they would be faint on the background; and cividis (Nuñez, Anderton and
 * Renslow, PLoS ONE 13 (2018) e0199239) for scales.
 */

const LIGHT = ["#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b8860b", "#56b4e9", "#7a5195"];
const DARK = ["#f2f2f2", "#56b4e9", "#ff8c42", "#2fd6a3", "#f0a3cc", "#f0e442", "#7fa8ff", "#c9a0ff"];
const DASHES = [[], [8, 4], [2, 3], [10, 3, 2, 3]];

/**
 * Colour and dashes of the n-th case; colours repeat after eight, with other dashes.
 * @param {number} index
 * @param {"light" | "dark"} theme
 * @returns {{colour: string, dash: number[]}}
 */
export function lookOf(index, theme) {
  const colours = theme === "dark" ? DARK : LIGHT;
  return {
    colour: colours[index % colours.length],
    dash: DASHES[Math.floor(index / colours.length) % DASHES.length],
  };
}

const CIVIDIS = [
  "#00224e",
  "#123570",
  "#3b496c",
  "#575d6d",
  "#707173",
  "#8a8678",
  "#a59c74",
  "#c3b369",
  "#e1cc55",
  "#fee838",
].map((hex) => [1, 3, 5].map((i) => Number.parseInt(hex.slice(i, i + 2), 16) / 255));

/**
 * Colour of a share between 0 and 1.
 * @param {number} share
 * @returns {[number, number, number]} red, green and blue, 0 to 1
 */
export function cividis(share) {
  const place = Math.min(1, Math.max(0, share)) * (CIVIDIS.length - 1);
  const low = Math.min(Math.floor(place), CIVIDIS.length - 2);
  return [0, 1, 2].map((i) => CIVIDIS[low][i] + (place - low) * (CIVIDIS[low + 1][i] - CIVIDIS[low][i]));
}

/**
 * Colour of a share between 0 and 1 on paper of a theme: without the end of the scale that is like it.
 * @param {number} share @param {"light" | "dark"} theme
 */
export const shadeOf = (share, theme) => {
  const inside = Math.min(1, Math.max(0, share));
  return cividis(theme === "dark" ? 0.3 + 0.7 * inside : 0.86 * inside);
};

/** The same as "rgb(...)". */
export const shadeText = (share, theme) =>
  `rgb(${shadeOf(share, theme)
    .map((part) => Math.round(255 * part))
    .join(",")})`;

/** The whole scale from left to right. */
export const shadeGradient = (theme) =>
  `linear-gradient(90deg, ${Array.from({ length: 9 }, (_, i) => shadeText(i / 8, theme)).join(", ")})`;
