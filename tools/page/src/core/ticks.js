/** Positions and texts of the ticks of an axis. */

const STEPS = [1, 2, 5, 10];

/**
 * @param {number} low
 * @param {number} high
 * @param {number} count about how many
 * @returns {number[]} multiples of 1, 2 or 5 times a power of ten
 */
export function linearTicks(low, high, count) {
  if (!(high > low)) return Number.isFinite(low) ? [low] : [];
  const raw = (high - low) / Math.max(1, count);
  const decade = 10 ** Math.floor(Math.log10(raw));
  const step = decade * STEPS.find((s) => s * decade >= raw * (1 - 1e-9));
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) ticks.push(Number((i * step).toPrecision(12)));
  return ticks;
}

/** Powers of ten, and their multiples by 2 and 5 where the range is less than two decades. */
export function logTicks(low, high) {
  const ticks = [];
  const factors = Math.log10(high / low) < 2 ? [1, 2, 5] : [1];
  for (let e = Math.floor(Math.log10(low)); 10 ** e <= high * (1 + 1e-9); ++e) {
    for (const f of factors) {
      const value = Number(`${f}e${e}`);
      if (value >= low * (1 - 1e-9) && value <= high * (1 + 1e-9)) ticks.push(value);
    }
  }
  return ticks;
}

/** A number with so many digits that it can be read: 12.35, 0.0012, 1.2e-7. */
export function short(value, digits = 4) {
  if (value === undefined || Number.isNaN(value)) return "–";
  if (!Number.isFinite(value)) return value > 0 ? "∞" : "−∞";
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 1e6))
    return minus(
      value
        .toExponential(Math.max(0, digits - 1))
        .replace(/\.?0+e/, "e")
        .replace("e+", "e"),
    );
  return minus(String(Number(value.toPrecision(digits))));
}

const minus = (text) => text.replaceAll("-", "−");

/** Texts of ticks, all with the decimals that distinguish them. */
export function tickTexts(ticks) {
  if (ticks.length < 2) return ticks.map((tick) => short(tick, 6));
  const step = Math.abs(ticks[1] - ticks[0]);
  const largest = Math.max(...ticks.map(Math.abs));
  if (largest >= 1e6 || largest < 1e-4) {
    const digits = Math.max(1, Math.ceil(Math.log10(largest / step) + 1e-9) + 1);
    return ticks.map((tick) => short(tick, digits));
  }
  let decimals = 0;
  while (decimals < 12 && Math.abs(step * 10 ** decimals - Math.round(step * 10 ** decimals)) > 1e-6 * step * 10 ** decimals)
    ++decimals;
  return ticks.map((tick) => minus(tick.toFixed(decimals)));
}
