/**
 * Differences between two cases at equal arc length of the original program. Their times differ: a
 * rewritten program, or a strategy that slows an axis down, reaches the same point at another time.
 */

/** Path that is a standstill, rounding included (mm). */
const STANDSTILL = 1e-7;

/** Row behind the last one that has the arc length of `row`. */
function endOfStandstill(s, row) {
  let end = row + 1;
  while (end < s.length && s[end] - s[row] < STANDSTILL) ++end;
  return end;
}

/** Value at a fraction of the rows `from` to `to`, the last included. */
function atFraction(values, from, to, fraction) {
  const place = from + fraction * (to - from);
  const row = Math.min(Math.floor(place), to - 1);
  if (row < from) return values[from];
  return values[row] + (place - row) * (values[row + 1] - values[row]);
}

/**
 * Values of one case minus those of a baseline at equal s, linear between the rows of the baseline.
 * During a standstill rows are compared at equal fractions of it; a single row, with its end.
 * @param {ArrayLike<number>} s arc length of the rows, not falling
 * @param {ArrayLike<number>} values
 * @param {ArrayLike<number>} sBase arc length of the rows of the baseline, not falling
 * @param {ArrayLike<number>} base its values
 * @returns {Float64Array} one for each row; NaN beyond the path of the baseline
 */
export function differenceAtEqualS(s, values, sBase, base) {
  const out = new Float64Array(s.length).fill(NaN);
  let at = 0; // the last row of the baseline that is not beyond s
  for (let row = 0; row < s.length;) {
    const end = endOfStandstill(s, row);
    while (at < sBase.length && sBase[at] < s[row] - STANDSTILL) ++at;
    if (at === sBase.length) break;
    if (sBase[at] - s[row] < STANDSTILL) {
      const last = endOfStandstill(sBase, at) - 1;
      for (let i = row; i < end; ++i) {
        const fraction = end - row === 1 ? 1 : (i - row) / (end - 1 - row);
        out[i] = values[i] - atFraction(base, at, last, fraction);
      }
    } else if (at > 0) {
      const share = (s[row] - sBase[at - 1]) / (sBase[at] - sBase[at - 1]);
      const there = base[at - 1] + share * (base[at] - base[at - 1]);
      for (let i = row; i < end; ++i) out[i] = values[i] - there;
    }
    row = end;
  }
  return out;
}
