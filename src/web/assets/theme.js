// Which colours: those of the system, or the reader's choice. Runs before the page
// is painted, so that nothing flashes in the other scheme.
"use strict";

globalThis.colours = (() => {
  const KEY = "servoscope-colours";
  const CONDITIONS = { auto: "screen and (prefers-color-scheme: dark)", light: "not all", dark: "all" };
  const link = document.getElementById("dark");

  function stored() {
    // A browser may refuse to keep anything; the system's colours are then as good.
    try {
      return localStorage.getItem(KEY) ?? "auto";
    } catch {
      return "auto";
    }
  }

  function choose(choice) {
    colours.choice = choice in CONDITIONS ? choice : "auto";
    link.media = colours.dark();
    try {
      localStorage.setItem(KEY, colours.choice);
    } catch {
      // It holds until the page is left.
    }
    document.dispatchEvent(new Event("colours"));
  }

  const colours = { choice: "auto", choose, dark: () => CONDITIONS[colours.choice] };
  choose(stored());
  document.addEventListener("DOMContentLoaded", () => {
    const select = document.getElementById("colours");
    select.value = colours.choice;
    select.addEventListener("change", () => choose(select.value));
  });
  return colours;
})();
