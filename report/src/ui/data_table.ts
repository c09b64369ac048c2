// SPDX-License-Identifier: MIT
// SPDX-FileCopyrightText: posemix contributors
// A table of any size: sorted by any column, narrowed by words, page by page, with bars behind its numbers.
import type { Json } from "../payload.ts";
import { isNumber, keyColumns, linkColumn, valuesOf } from "../study/columns.ts";
import { shownTable } from "../study/shown.ts";
import type { Table } from "./csv.ts";
import { button, choice, element } from "./dom.ts";
import { formatted, titleOf } from "./format.ts";

const ROWS_OF_PAGE = 100;
const MOST_CHOICES = 20;
const LEAST_FOR_TOOLS = 8;
const MOST_WORDS = 6;

/** The decimals that a column's numbers share, so that they stand below one another; undefined if their sizes differ too much. */
export function decimalsOf(values: readonly Json[]): number | undefined {
  const sizes = values.filter(isNumber).filter((value) => value !== 0).map(Math.abs).sort((a, b) => a - b);
  if (sizes.length === 0 || values.filter(isNumber).every(Number.isInteger)) return 0;
  const [least, middle, most] = [sizes[Math.floor(0.05 * sizes.length)], sizes[Math.floor(0.5 * sizes.length)], sizes[sizes.length - 1]];
  if (most / least > 1e5 || most >= 1e7 || middle < 1e-4) return undefined;
  return Math.max(0, Math.min(6, 3 - Math.floor(Math.log10(middle))));
}

/** A path that a link of a table may have: below the page's folder, and nothing but a path. */
export function safePath(value: Json | undefined): string | undefined {
  if (typeof value !== "string" || value === "" || /[\\:?#\u0000-\u001f]/.test(value) || value.startsWith("/")) return undefined;
  const parts = value.split("/");
  return parts.some((part) => part === ".." || part === "") ? undefined : parts.map(encodeURIComponent).join("/");
}

/** The table as comma-separated values; a cell with a comma, a quote or a line's end is quoted. */
export function csvOf({ columns, rows }: Table): string {
  const cell = (value: Json) => {
    const text = value === null ? "" : typeof value === "object" ? JSON.stringify(value) : String(value);
    return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  };
  return [columns, ...rows].map((row) => row.map(cell).join(",")).join("\n") + "\n";
}

/** Numbers before words before nothing. */
function compare(a: Json, b: Json): number {
  if (isNumber(a) && isNumber(b)) return a - b;
  const rank = (value: Json) => (isNumber(value) ? 0 : value === null ? 2 : 1);
  if (rank(a) !== rank(b)) return rank(a) - rank(b);
  return String(a).localeCompare(String(b), "en", { numeric: true });
}

interface Column {
  numeric: boolean;
  title: { name: string; unit: string };
  decimals: number | undefined;
  most: number;
  bars: boolean;
}

export class DataTable {
  readonly node = element("section", { class: "data-table" });
  private readonly columns: Column[];
  private readonly body = element("tbody");
  private readonly count = element("p", { class: "hint", role: "status" });
  private readonly pager = element("div", { class: "buttons pager" });
  private readonly heads: HTMLElement[];
  /** As it is shown, by the same numbers of rows and columns as the data. */
  private readonly seen: Table;
  private readonly keys: ReadonlySet<string>;
  /** The column with the pages of the rows' runs. */
  private readonly link: number;
  /** Columns in the order in which they stand: the link beside the name of its row, not behind all numbers. */
  private readonly order: readonly number[];
  private readonly only = new Map<number, string>();
  /** Whether every row is another quantity, so that its numbers are like each other, and not like those above. */
  private readonly isByRow: boolean;
  private words = "";
  private sorted = -1;
  private falling = false;
  private page = 0;

  constructor(private readonly name: string, private readonly table: Table) {
    this.keys = new Set(keyColumns(table));
    this.link = linkColumn(table);
    const others = table.columns.map((_, k) => k).filter((k) => k !== this.link);
    this.order = this.link < 0 ? others : [...others.slice(0, 1), this.link, ...others.slice(1)];
    this.isByRow = table.columns.includes("figure");
    this.seen = shownTable(table);
    this.columns = table.columns.map((_, k) => this.columnOf(k));
    this.shareDecimals();
    this.heads = table.columns.map((_, k) => this.head(k));
    const made = element("table", {}, element("caption", { class: "unseen" }, name), element("thead", {}, element("tr", {}, ...this.order.map((k) => this.heads[k]))), this.body);
    const scroll = element("div", { class: "scroll tall", tabindex: 0, role: "region", "aria-label": `Table ${name}` }, made);
    this.node.append(element("h2", {}, name), this.tools(), scroll, this.pager);
    this.fill();
  }

  private columnOf(k: number): Column {
    const values = this.valuesAt(k);
    const numeric = values.some(isNumber) && values.every((value) => value === null || isNumber(value));
    const sizes = numeric ? values.filter(isNumber).map(Math.abs) : [];
    const isKey = this.keys.has(this.table.columns[k]);
    return { numeric, title: titleOf(this.seen.columns[k]), decimals: numeric ? decimalsOf(values) : undefined, most: sizes.reduce((most, size) => Math.max(most, size), 0), bars: numeric && !this.isByRow && !isKey && k > 0 && new Set(sizes).size > 1 };
  }

  private valuesAt(k: number): Json[] {
    return this.seen.rows.map((row) => row[k] ?? null);
  }

  /** Columns of one unit have the same decimals, where their sizes allow it. */
  private shareDecimals(): void {
    for (const unit of ["mm", "deg"]) {
      const own = this.columns.flatMap((column, k) => (column.numeric && column.title.unit === unit && !this.keys.has(this.table.columns[k]) ? [k] : []));
      const decimals = decimalsOf(own.flatMap((k) => this.valuesAt(k)));
      if (decimals !== undefined) for (const k of own) this.columns[k].decimals = decimals;
    }
  }

  private head(k: number): HTMLElement {
    const { name, unit } = this.columns[k].title;
    const press = button(unit ? `${name} [${unit}]` : name || "–", () => this.sort(k), { class: "sort" });
    return element("th", { scope: "col", class: this.columns[k].numeric ? "number" : "" }, press);
  }

  private tools(): HTMLElement {
    const { table } = this;
    const save = button("Save CSV", () => this.save(), { "aria-label": `Save CSV of ${this.name}` });
    if (table.rows.length < LEAST_FOR_TOOLS) return element("div", { class: "controls" }, save, this.count);
    const box = element("input", { type: "search", "aria-label": `Rows of ${this.name} with the words`, placeholder: "Rows with the words …" });
    box.addEventListener("input", () => this.narrow(() => (this.words = box.value.toLowerCase())));
    const lists = table.columns.flatMap((column, k) => {
      const values = valuesOf(this.seen, this.seen.columns[k]);
      if (!this.keys.has(column) || values.length > MOST_CHOICES || this.columns[k].numeric) return [];
      return [choice(titleOf(column).name, [["", "every"], ...values.map((value) => [value, value] as const)], "",
        (value) => this.narrow(() => (value === "" ? this.only.delete(k) : this.only.set(k, value))))];
    });
    return element("div", { class: "controls" }, box, ...lists.slice(0, 5), save, this.count);
  }

  private narrow(change: () => void): void {
    change();
    this.page = 0;
    this.fill();
  }

  private sort(k: number): void {
    // Numbers begin with the largest, words with the first.
    this.falling = this.sorted === k ? !this.falling : this.columns[k].numeric;
    this.sorted = k;
    this.page = 0;
    this.fill();
  }

  /** The rows that are left, in their order, with their numbers in the table. */
  shown(): [Json[], number][] {
    const { sorted, falling, words } = this;
    const left = this.seen.rows.map((row, i): [Json[], number] => [row, i]).filter(([row]) =>
      [...this.only].every(([k, value]) => String(row[k]) === value)
      && (words === "" || words.split(/\s+/).every((word) => row.some((cell, k) => k !== this.link && String(cell ?? "").toLowerCase().includes(word)))));
    if (sorted >= 0) {
      left.sort(([a], [b]) => {
        if (a[sorted] === null || b[sorted] === null) return a[sorted] === b[sorted] ? 0 : a[sorted] === null ? 1 : -1;
        return (falling ? -1 : 1) * compare(a[sorted], b[sorted]);
      });
    }
    return left;
  }

  /** What tells a row from the others: "0022, 4, midway". */
  private nameOf(row: number): string {
    const keys = this.columns.map((_, k) => k).filter((k) => this.keys.has(this.table.columns[k]));
    // Numbers behind the words may be results that are whole by chance.
    const last = keys.map((k) => this.columns[k].numeric).lastIndexOf(false);
    const words = keys.slice(0, last < 0 ? keys.length : last + 1).map((k) => this.seen.rows[row][k] ?? null).filter((value) => value !== null);
    return words.length > 0 ? words.slice(0, MOST_WORDS).join(", ") : `row ${row + 1}`;
  }

  /** The page of the row's run; nothing where it has none. */
  private opener(row: number): Node | string {
    const value = this.table.rows[row][this.link] ?? null;
    const path = safePath(value);
    if (path === undefined) return value === null ? "" : formatted(value);
    return element("a", { href: path, "aria-label": `open the run of ${this.nameOf(row)}` }, "open");
  }

  private cell(shown: Json, k: number, row: number): HTMLElement {
    const column = this.columns[k];
    const name = this.table.columns[k];
    const value = this.table.rows[row][k] ?? null;
    const decimals = this.isByRow ? decimalsOf(this.seen.rows[row]) : column.decimals;
    const written = isNumber(shown) && decimals !== undefined ? shown.toFixed(decimals) : formatted(shown);
    const attributes = { class: column.numeric ? "number" : "", "data-key": `${this.name}/${row}/${name}`, "data-value": JSON.stringify(value) };
    const content = k === this.link ? this.opener(row) : written;
    const made = k === this.order[0] ? element("th", { scope: "row", ...attributes }, content) : element("td", attributes, content);
    if (column.bars && isNumber(shown) && column.most > 0) made.style.setProperty("--bar", `${((100 * Math.abs(shown)) / column.most).toFixed(1)}%`);
    return made;
  }

  private fill(): void {
    const rows = this.shown();
    const pages = Math.max(1, Math.ceil(rows.length / ROWS_OF_PAGE));
    this.page = Math.min(this.page, pages - 1);
    const from = this.page * ROWS_OF_PAGE;
    const part = rows.slice(from, from + ROWS_OF_PAGE);
    this.body.replaceChildren(...part.map(([row, i]) => element("tr", {}, ...this.order.map((k) => this.cell(row[k] ?? null, k, i)))));
    this.heads.forEach((head, k) => head.setAttribute("aria-sort", k !== this.sorted ? "none" : this.falling ? "descending" : "ascending"));
    const all = this.table.rows.length;
    const left = rows.length < all ? `${rows.length} of ${all} rows` : `${all} rows`;
    this.count.textContent = pages > 1 ? `${left}; ${from + 1} to ${from + part.length} are shown` : left;
    this.pager.hidden = pages === 1;
    const step = (name: string, to: number) => button(name, () => ((this.page = to), this.fill()), { disabled: to < 0 || to >= pages });
    if (pages > 1) this.pager.replaceChildren(step("Rows before", this.page - 1), step("Next rows", this.page + 1));
  }

  private save(): void {
    const text = csvOf({ columns: this.table.columns, rows: this.shown().map(([, i]) => this.table.rows[i]) });
    const address = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
    element("a", { href: address, download: `${this.name.replaceAll(/[^A-Za-z0-9._-]+/g, "_").replace(/\.csv$/, "")}.csv` }).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  }
}
