// Figures as files.

/** Dots an inch: those of a drawing's lengths, and those of a printed picture. */
const DRAWING_DPI = 96;
const PRINT_DPI = 300;

/** A drawing on its own, in the colours and the size it was drawn in. */
function standalone(drawing) {
  const copy = drawing.cloneNode(true);
  const { width, height } = drawing.viewBox.baseVal;
  for (const name of ["role", "aria-labelledby", "aria-describedby"]) copy.removeAttribute(name);
  copy.setAttribute("width", width);
  copy.setAttribute("height", height);
  return { width, height, text: new XMLSerializer().serializeToString(copy) };
}

/** A drawing as a picture for print. */
async function picture(drawing) {
  const { width, height, text } = standalone(drawing);
  const address = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
  const image = new Image();
  image.src = address;
  await image.decode();
  const canvas = document.createElement("canvas");
  canvas.width = Math.ceil((width * PRINT_DPI) / DRAWING_DPI);
  canvas.height = Math.ceil((height * PRINT_DPI) / DRAWING_DPI);
  canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
  URL.revokeObjectURL(address);
  return new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
}

/** Shows every drawing, and offers it as a file. */
async function fillFigures() {
  for (const figure of document.querySelectorAll("figure[data-name]")) {
    const { name } = figure.dataset;
    const script = figure.querySelector("script");
    const text = await embedded(script).catch(unread(script));
    if (text === null) continue;
    script.outerHTML = text;
    const drawing = figure.querySelector("svg");
    figure.querySelector(".svg").addEventListener("click", () => {
      download(`${name}.svg`, standalone(drawing).text, "image/svg+xml");
    });
    figure.querySelector(".png").addEventListener("click", async () => {
      download(`${name}.png`, await picture(drawing), "image/png");
    });
  }
}
