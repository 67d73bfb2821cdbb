import assert from "node:assert/strict";
import { describe, it } from "node:test";
import { csvText } from "../../../tools/page/src/core/csv.js";
import { lookOf } from "../../../tools/page/src/core/palette.js";
import { linearTicks, logTicks, short, tickTexts } from "../../../tools/page/src/core/ticks.js";
import { unitText, withUnit } from "../../../tools/page/src/core/units.js";

describe("ticks", () => {
  it("are multiples of 1, 2 or 5 within the range", () => {
    assert.deepEqual(linearTicks(0, 1, 5), [0, 0.2, 0.4, 0.6, 0.8, 1]);
    assert.deepEqual(linearTicks(-3.2, 4.1, 4), [-2, 0, 2, 4]);
    assert.deepEqual(linearTicks(5, 5, 4), [5]);
    assert.deepEqual(linearTicks(NaN, 1, 4), []);
  });

  it("have the decimals that tell them apart", () => {
    assert.deepEqual(tickTexts([0, 0.25, 0.5]), ["0.00", "0.25", "0.50"]);
    assert.deepEqual(tickTexts([-20, 0, 20]), ["−20", "0", "20"]);
    assert.deepEqual(tickTexts([1e-6, 2e-6]), ["1e−6", "2e−6"]);
    for (const close of [
      [1200000, 1200100, 1200200],
      [0.00001234, 0.000012341],
      [1e6, 1000001],
    ]) {
      assert.equal(new Set(tickTexts(close)).size, close.length);
    }
  });

  it("of a logarithmic axis are decades", () => {
    assert.deepEqual(logTicks(1, 1000), [1, 10, 100, 1000]);
    assert.deepEqual(logTicks(3, 30), [5, 10, 20]);
  });
});

describe("numbers", () => {
  it("are short", () => {
    assert.equal(short(19.98765), "19.99");
    assert.equal(short(-0.00012346), "−0.0001235");
    assert.equal(short(1.5e-7), "1.5e−7");
    assert.equal(short(0), "0");
    assert.equal(short(NaN), "–");
  });
});

describe("units", () => {
  it("are written as people write them", () => {
    assert.equal(unitText("um"), "µm");
    assert.equal(unitText("mm s-1"), "mm/s");
    assert.equal(unitText("m^2"), "m²");
    assert.equal(withUnit("blocks", "1"), "blocks");
    assert.equal(withUnit("contour_error", "um"), "contour_error (µm)");
    assert.equal(unitText("< 2 um"), "< 2 µm");
  });
});

describe("CSV", () => {
  it("quotes what needs it and leaves empty what is no number", () => {
    assert.equal(
      csvText(
        ["a", "b, c"],
        [
          [1, "x"],
          [NaN, 'say "y"'],
        ],
      ),
      'a,"b, c"\n1,x\n,"say ""y"""\n',
    );
  });
});

describe("looks of cases", () => {
  const luminance = (hex) =>
    [1, 3, 5]
      .map((i) => Number.parseInt(hex.slice(i, i + 2), 16) / 255)
      .map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4))
      .reduce((sum, c, i) => sum + c * [0.2126, 0.7152, 0.0722][i], 0);
  const contrast = (a, b) => (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);

  it("differ for 32 cases, and are seen on their paper", () => {
    for (const [theme, paper] of [
      ["light", 1],
      ["dark", 0.0095],
    ]) {
      const looks = Array.from({ length: 32 }, (_, i) => lookOf(i, theme));
      assert.equal(new Set(looks.map((look) => JSON.stringify(look))).size, 32);
      for (const { colour } of looks) assert.ok(contrast(luminance(colour), paper) > 2, `${colour} on ${theme}`);
    }
  });
});
