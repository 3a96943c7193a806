// Axes: from values to pixels, round ticks, and numbers and names as people read them.
"use strict";

globalThis.charts = globalThis.charts ?? {};

(() => {
  const MINUS = "\u2212";

  // Where a value of an axis lies in pixels, and back.
  function scale(axis, [from, to]) {
    const log = axis.scale === "log";
    const forth = log ? Math.log10 : (value) => value;
    const [low, high] = axis.range.map(forth);
    const perUnit = (to - from) / (high - low);
    return {
      at: (value) => from + (forth(value) - low) * perUnit,
      value: (pixel) => {
        const inner = low + (pixel - from) / perUnit;
        return log ? 10 ** inner : inner;
      },
      ticks: log ? logTicks(axis.range) : linearTicks(axis.range, Math.abs(to - from) / (to > from ? 75 : 42)),
    };
  }

  // Steps of 1, 2 or 5 times a power of ten: about so many ticks. Words lie wide and stand close.
  function linearTicks([low, high], about) {
    const rough = (high - low) / Math.max(2, about);
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((k) => k * power).find((candidate) => candidate >= rough);
    const ticks = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; k += 1) {
      ticks.push({ value: k * step, text: fixed(k * step, Math.max(0, -Math.floor(Math.log10(step) + 1e-9))) });
    }
    return ticks;
  }

  // Decades, and 2 and 5 between them where there are few.
  function logTicks([low, high]) {
    const decades = Math.log10(high / low);
    const factors = decades > 3.5 ? [1] : [1, 2, 5];
    const ticks = [];
    for (let power = Math.floor(Math.log10(low)); 10 ** power <= high; power += 1) {
      for (const factor of factors) {
        const value = factor * 10 ** power;
        if (value >= low && value <= high) ticks.push({ value, text: number(value, 1) });
      }
    }
    return ticks;
  }

  // As many digits after the point as stated, groups of three from ten thousand on, a true minus.
  function fixed(value, digits) {
    const [whole, fraction] = Math.abs(value).toFixed(Math.min(digits, 12)).split(".");
    const grouped = whole.length > 4 ? whole.replace(/\B(?=(\d{3})+$)/g, "\u202f") : whole;
    const text = fraction ? `${grouped}.${fraction}` : grouped;
    return value < 0 && Number(text.replaceAll("\u202f", "")) !== 0 ? MINUS + text : text;
  }

  // As many significant digits as stated.
  function number(value, significant = 4) {
    if (value === 0) return "0";
    const power = Math.floor(Math.log10(Math.abs(value)));
    return fixed(value, Math.max(0, significant - 1 - power));
  }

  // What a foreign name would hide or turn around, by its number: control characters, joiners, marks of direction.
  const HIDDEN = /[\p{Cc}\p{Cf}\p{Zl}\p{Zp}]/gu;
  const visible = (text) => String(text).replace(HIDDEN, (letter) => `\\u{${letter.codePointAt(0).toString(16)}}`);

  Object.assign(globalThis.charts, { scale, number, visible });
})();
