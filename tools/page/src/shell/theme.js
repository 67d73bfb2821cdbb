/** Light and dark: that of the system until the user chooses. */

const KEY = "servomill-theme";

const stored = () => {
  try {
    return localStorage.getItem(KEY);
  } catch {
    return null; // pages from file:// may have none
  }
};

/** @returns {"light" | "dark"} */
export const preferredTheme = () => stored() ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");

/** Applies the theme of the store, and follows that of the system. */
export function followTheme(store) {
  const apply = () => {
    document.documentElement.dataset.theme = store.state.theme;
  };
  store.on(["theme"], apply);
  store.state.theme = preferredTheme();
  apply();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => store.set({ theme: preferredTheme() }));
}

export function toggleTheme(store) {
  const theme = store.state.theme === "dark" ? "light" : "dark";
  try {
    localStorage.setItem(KEY, theme);
  } catch {
    // it lasts as long as the page
  }
  store.set({ theme });
}

/** Colours of drawings, from the style sheet. */
export function inks() {
  const style = getComputedStyle(document.documentElement);
  const value = (name) => style.getPropertyValue(`--${name}`).trim();
  return {
    ink: value("ink"),
    faint: value("faint"),
    grid: value("grid"),
    paper: value("paper"),
    accent: value("accent"),
    band: value("band"),
  };
}
