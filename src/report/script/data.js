// Data that stands in the page, and how it leaves it.

/** The text of a data script, as it was before it was put into the page. */
async function embedded(script) {
  const text = script.textContent;
  if (script.dataset.encoding === "text") {
    return text.replaceAll("&lt;", "<").replaceAll("&amp;", "&");
  }
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).text();
}

/** Says in place of an element's content that it cannot be read: for a browser without decompression. */
function unread(element) {
  return (error) => {
    const note = document.createElement("p");
    note.className = "note";
    note.textContent = `This browser cannot read what belongs here (${error.message}).`;
    element.after(note);
    return null;
  };
}

/** The text of a table as comma-separated values. */
function tableText(name) {
  return embedded(document.querySelector(`script[data-table="${CSS.escape(name)}"]`));
}

/** Rows of cells from comma-separated values as RFC 4180 has them. */
function parseCsv(text) {
  const rows = [];
  let row = [];
  // A cell in quotes, with quotes doubled, or without; then a comma, the line's end or the text's.
  const pattern = /(?:"((?:[^"]|"")*)"|([^",\n]*))(,|\n|$)/gy;
  while (pattern.lastIndex < text.length) {
    const [, quoted, plain, end] = pattern.exec(text);
    row.push(quoted === undefined ? plain : quoted.replaceAll('""', '"'));
    if (end !== ",") {
      rows.push(row);
      row = [];
    }
  }
  return rows;
}

/** Hands a file to the reader. */
function download(name, content, type) {
  const address = URL.createObjectURL(new Blob([content], { type }));
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

/** Every button that offers a table or a file as it stands on the page. */
function offerDownloads() {
  for (const button of document.querySelectorAll("[data-download]")) {
    const name = button.dataset.download;
    button.addEventListener("click", async () => {
      download(`${name}.csv`, await tableText(name), "text/csv");
    });
  }
  for (const button of document.querySelectorAll("[data-file]")) {
    button.addEventListener("click", () => {
      const text = document.getElementById(button.dataset.file).textContent;
      download(button.dataset.name, text, "text/plain");
    });
  }
}
