// Tables that sort and filter.

/** Rows shown before the reader asks for more. */
const FIRST_ROWS = 50;

/** Rows that each further request adds. */
const MORE_ROWS = 1000;

/** A cell with more letters may be broken into lines. */
const LONG_TEXT = 40;

/** `toFixed` rounds what lies halfway between two numbers up; here it is rounded to the even digit, as in the other tables. */
function fixed(number, places) {
  const scaled = Math.abs(number) * 10 ** places;
  const below = Math.floor(scaled);
  // A binary number is halfway only where a power of five cancels.
  const halfway = scaled === below + 0.5 && (2 * below + 1) % 5 ** places === 0;
  const even = halfway && below % 2 === 0;
  return (even ? (Math.sign(number) * below) / 10 ** places : number).toFixed(places);
}

/** A number as people read it: five significant digits, in plain notation where that is readable. */
function significant(number) {
  if (!Number.isFinite(number)) return number === Infinity ? "∞" : "–";
  const magnitude = number === 0 ? 0 : Math.floor(Math.log10(Math.abs(number)));
  const [digits, exponent] = number.toExponential(3).split("e");
  return magnitude >= -4 && magnitude < 7
    ? fixed(number, Math.max(4 - magnitude, 0))
    : `${digits}e${Number(exponent)}`;
}

/** A cell's number; infinite where it says so, none where it is empty. */
function numberOf(cell) {
  if (cell === "") return NaN;
  return cell.endsWith("inf") ? (cell.startsWith("-") ? -Infinity : Infinity) : Number(cell);
}

/** What to show for a cell of a column of this kind. */
function shown(cell, kind) {
  if (kind === "real") return significant(numberOf(cell));
  return kind === "count" && cell === "" ? "–" : cell;
}

/** Compares cells of one column; what is infinite, then what is missing comes last, whatever the direction. */
function comparison(kind, direction) {
  if (kind === "text") {
    const collator = new Intl.Collator("en", { numeric: true });
    return (a, b) => (a === "") - (b === "") || direction * collator.compare(a, b);
  }
  const rank = (number) => (Number.isFinite(number) ? 0 : Number.isNaN(number) ? 2 : 1);
  return (a, b) => {
    const [x, y] = [numberOf(a), numberOf(b)];
    return rank(x) - rank(y) || (rank(x) === 0 ? direction * (x - y) : 0);
  };
}

/** One table of the page: its rows, which of them show, and in what order. */
class DataTable {
  constructor(section, rows) {
    const [header, ...body] = rows;
    this.section = section;
    this.kinds = section.dataset.kinds.split(" ");
    this.header = header;
    this.rows = body;
    // What is empty throughout says nothing.
    this.columns = header.map((_, k) => k).filter((k) => this.kinds[k] !== "text" || body.some((row) => row[k]));
    this.texts = body.map((row) => this.columns.map((k) => `${row[k]} ${shown(row[k], this.kinds[k])}`).join(" ").toLowerCase());
    this.sorted = { column: -1, direction: 1 };
    this.limit = FIRST_ROWS;
    this.table = section.querySelector("table");
    this.filter = section.querySelector("input");
    this.count = section.querySelector("output");
    this.more = section.querySelector(".more");
    this.filter?.addEventListener("input", () => this.fill());
    this.more.addEventListener("click", () => {
      this.limit += MORE_ROWS;
      this.fill();
    });
    this.head();
    this.fill();
  }

  /** The header: a button in every cell. */
  head() {
    const row = this.table.createTHead().insertRow();
    this.cells = this.columns.map((k) => {
      const cell = document.createElement("th");
      cell.scope = "col";
      cell.className = this.kinds[k];
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = this.header[k];
      button.addEventListener("click", () => this.sort(k));
      cell.append(button);
      row.append(cell);
      return cell;
    });
    this.body = this.table.createTBody();
  }

  /** By a column, ascending; again, descending. */
  sort(column) {
    const again = this.sorted.column === column;
    this.sorted = { column, direction: again ? -this.sorted.direction : 1 };
    this.columns.forEach((k, i) => {
      if (k === column) this.cells[i].ariaSort = this.sorted.direction > 0 ? "ascending" : "descending";
      else this.cells[i].removeAttribute("aria-sort");
    });
    this.fill();
  }

  /** Indices of the rows in which every word of the filter stands, in order. */
  matches() {
    const words = (this.filter?.value ?? "").toLowerCase().split(/\s+/).filter(Boolean);
    const matches = this.texts.flatMap((text, i) => (words.every((word) => text.includes(word)) ? [i] : []));
    const { column, direction } = this.sorted;
    if (column < 0) return matches;
    const compare = comparison(this.kinds[column], direction);
    return matches.sort((i, j) => compare(this.rows[i][column], this.rows[j][column]) || i - j);
  }

  /** The body, and how much of the table it is. */
  fill() {
    const matches = this.matches();
    const visible = matches.slice(0, this.limit);
    this.body.replaceChildren(...visible.map((i) => this.row(this.rows[i])));
    if (this.count) {
      const few = matches.length < this.rows.length;
      const rows = this.rows.length === 1 ? "row" : "rows";
      this.count.textContent = few ? `${matches.length} of ${this.rows.length} ${rows}` : `${matches.length} ${rows}`;
    }
    const hidden = matches.length - visible.length;
    this.more.hidden = hidden === 0;
    const all = hidden <= MORE_ROWS;
    this.more.textContent = all ? `Show the other ${hidden} rows` : `Show ${MORE_ROWS} more of ${hidden} rows`;
  }

  row(cells) {
    const row = document.createElement("tr");
    for (const k of this.columns) {
      const cell = row.insertCell();
      cell.className = this.kinds[k];
      cell.classList.toggle("long", cells[k].length > LONG_TEXT);
      cell.textContent = shown(cells[k], this.kinds[k]);
    }
    return row;
  }
}

/** Fills in every table of the page. */
async function fillTables() {
  for (const section of document.querySelectorAll(".table")) {
    const text = await tableText(section.dataset.name).catch(unread(section));
    if (text !== null) new DataTable(section, parseCsv(text));
  }
}
