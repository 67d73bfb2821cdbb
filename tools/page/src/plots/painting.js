/** What is painted on the canvas of a uPlot: bands of sections and the curves themselves. */

/** @typedef {{colour: string, opacity: number, width: number, dash: number[]}} Look */

/** Calls `paint` with the canvas limited to the area of the plot. */
export function paintWithin({ ctx, bbox }, paint) {
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  paint();
  ctx.restore();
}

/** Parts of the abscissa that are highlighted. @param {[number, number][]} bands */
export function paintBands(u, bands, colour) {
  paintWithin(u, () => {
    u.ctx.fillStyle = colour;
    for (const [from, to] of bands) {
      const [left, right] = [u.valToPos(from, "x", true), u.valToPos(to, "x", true)];
      u.ctx.fillRect(left, u.bbox.top, Math.max(1, right - left), u.bbox.height);
    }
  });
}

/** Offset and factor from values to pixels of the canvas. */
function linear(u, scale) {
  const { min, max } = u.scales[scale];
  const [low, high] = [u.valToPos(min, scale, true), u.valToPos(max, scale, true)];
  const factor = (high - low) / (max - min);
  return [low - factor * min, factor];
}

/** A line through points; NaN lifts the pen. @param {Look} look */
export function strokeCurve(u, { x, y }, look) {
  const { ctx } = u;
  const [ax, bx] = linear(u, "x");
  const [ay, by] = linear(u, "y");
  ctx.beginPath();
  let down = false;
  for (let i = 0; i < x.length; ++i) {
    if (y[i] !== y[i]) down = false;
    else if (down) ctx.lineTo(ax + bx * x[i], ay + by * y[i]);
    else {
      ctx.moveTo(ax + bx * x[i], ay + by * y[i]);
      down = true;
    }
  }
  ctx.lineJoin = "round";
  ctx.strokeStyle = look.colour;
  ctx.globalAlpha = look.opacity;
  ctx.lineWidth = look.width * devicePixelRatio;
  ctx.setLineDash(look.dash.map((length) => length * devicePixelRatio));
  ctx.stroke();
}
