/** Elements of the page, made in one expression. */

function fill(element, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== undefined) element.setAttribute(name, String(value));
  }
  element.append(...children.filter((child) => child !== undefined && child !== null));
  return element;
}

/**
 * @param {string} tag
 * @param {Record<string, any>} [attributes] functions under onclick, onchange ...
 * @param {...(Node | string | undefined)} children
 */
export const html = (tag, attributes = {}, ...children) => fill(document.createElement(tag), attributes, children);

/** The same for a drawing. */
export const svg = (tag, attributes = {}, ...children) =>
  fill(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);

/** A list of choices with its label. */
export function select(label, options, value, onchange) {
  return html(
    "label",
    {},
    `${label} `,
    html(
      "select",
      { onchange: (event) => onchange(event.target.value) },
      ...options.map(([key, text]) => html("option", { value: key, selected: key === value }, text)),
    ),
  );
}

/** A button with a text and what it does. */
export const button = (text, title, onclick, attributes = {}) =>
  html("button", { type: "button", title, onclick, ...attributes }, text);

/** A box to be ticked, with its label. */
export const checkbox = (label, checked, onchange) =>
  html("label", {}, html("input", { type: "checkbox", checked, onchange: (event) => onchange(event.target.checked) }), ` ${label}`);

/** A slider with its label and value; of powers of ten if log. */
export function slider(label, { min, max, step, value, text }, oninput) {
  const shown = html("output", {}, text(value));
  const input = html("input", { type: "range", min, max, step, value });
  input.addEventListener("input", () => {
    shown.textContent = text(Number(input.value));
    oninput(Number(input.value));
  });
  return html("label", {}, `${label} `, input, shown);
}
