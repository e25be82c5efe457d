// What happens when the page opens.

const darkScheme = matchMedia("(prefers-color-scheme: dark)");

/** Whether the page is dark now: as the button says, or else as the system does. */
function isDark() {
  const { theme } = document.documentElement.dataset;
  return theme ? theme === "dark" : darkScheme.matches;
}

/** The button that changes between light and dark. */
function offerTheme(changed) {
  const button = document.getElementById("theme");
  const tell = () => {
    button.textContent = isDark() ? "Light" : "Dark";
    button.ariaLabel = `${button.textContent} colours`;
    changed();
  };
  button.addEventListener("click", () => {
    document.documentElement.dataset.theme = isDark() ? "light" : "dark";
    tell();
  });
  darkScheme.addEventListener("change", tell);
  tell();
}

/** The player, where the experiment has motions. */
async function openPlayer() {
  const section = document.getElementById("motion");
  if (!section) return null;
  const script = document.getElementById("motions");
  const text = await embedded(script).catch(unread(script));
  return text === null ? null : new Player(section, JSON.parse(text));
}

offerDownloads();
await fillFigures();
const player = await openPlayer();
offerTheme(() => player?.view.draw());
await fillTables();
document.documentElement.dataset.ready = "";
