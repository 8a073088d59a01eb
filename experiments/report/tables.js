// The tables of results: sorted by a click on a column, filtered by scenes and methods, with the
// intervals behind each cell under the pointer.

// A number with as many digits as a reader may want to copy.
const precise = (value) =>
    (value === null || value === undefined ? "–" : Number(value.toPrecision(6)).toString());

// All that is known of one cell of a comparison, a line each.
function tellCell(cell, comparison) {
    const interval = (estimate) => estimate.interval ?
        `[${estimate.interval.map(precise).join(", ")}]` :
        `no interval: ${estimate.no_interval}`;
    const lines = [`${cell.scene}, ${cell.method}, ${cell.budget}`];
    if (cell.mean)
        lines.push(`${comparison.metric} ${precise(cell.mean.value)} ${interval(cell.mean)}`);
    if (cell.ratio) {
        const kind = cell.ratio_is_paired ? "paired by seed" : "Welch";
        const ratio = `× ${precise(cell.ratio.value)} of ${comparison.baseline}`;
        lines.push(`${ratio} ${interval(cell.ratio)}, ${kind}`);
    }
    if (cell.values.length > 0) {
        const seeds = cell.seeds.map((seed, i) => `${seed}: ${precise(cell.values[i])}`);
        lines.push(`seeds: ${seeds.join(", ")}`);
        const times = [cell.passes, cell.cpu_seconds, cell.wall_seconds].map(precise);
        lines.push(`${times[0]} spp, ${times[1]} s cpu, ${times[2]} s wall`);
    }
    if (cell.tail) lines.push(`largest seed over median: ${precise(cell.tail)}`);
    if (cell.noisy_reference)
        lines.push(`${precise(100 * cell.reference_share)} % of it is the reference's noise`);
    if (cell.measured < cell.planned)
        lines.push(`${cell.measured} of ${cell.planned} seeds measured`);
    return lines.join("\n");
}

class ResultTable {
    constructor(details, comparison) {
        this.details = details;
        this.name = `table of ${comparison.metric}`;
        details.append(details.querySelector(".footer"));  // it does not scroll with the table
        this.table = details.querySelector("table");
        this.body = this.table.tBodies[0];
        this.headers = [...this.table.tHead.rows[0].cells];
        this.original = [...this.body.rows];
        const labels = this.headers.map((header) => header.textContent);
        this.nLabels = this.original[0] ? this.original[0].querySelectorAll("th").length : 1;
        const cells = new Map(comparison.cells.map(
            (cell) => [[cell.scene, cell.budget, cell.method].join("\n"), cell]));
        for (const row of this.original) {
            const [scene, budget = report.budgets[0]] =
                [...row.cells].slice(0, this.nLabels).map((label) => label.textContent);
            [...row.cells].forEach((place, column) => {
                const cell = cells.get([scene, budget, labels[column]].join("\n"));
                if (cell === undefined || column < this.nLabels) return;
                place.title = tellCell(cell, comparison);
                if (cell.mean) place.dataset.value = cell.mean.value;
                place.addEventListener("click", () => showCell(cell));
            });
        }
        this.headers.forEach((header, column) => {
            header.tabIndex = 0;
            header.classList.add("sortable");
            header.addEventListener("click", () => this.sortBy(column));
            header.addEventListener("keydown", (event) => {
                if (event.key === "Enter") this.sortBy(column);
            });
        });
        this.restore();
        details.addEventListener("toggle", () => this.save());
    }

    // Up, down, and the third time in the experiment's order.
    sortBy(column) {
        const header = this.headers[column];
        const orders = {undefined: "ascending", ascending: "descending", descending: undefined};
        const order = orders[header.getAttribute("aria-sort") ?? undefined];
        for (const other of this.headers) other.removeAttribute("aria-sort");
        const rows = [...this.original];
        if (order !== undefined) {
            header.setAttribute("aria-sort", order);
            const sign = order === "ascending" ? 1 : -1;
            rows.sort((a, b) => sign * this.compare(a.cells[column], b.cells[column]));
        }
        this.body.append(...rows);
        this.save();
    }

    save() {
        const column = this.headers.findIndex((header) => header.hasAttribute("aria-sort"));
        const order = this.headers[column]?.getAttribute("aria-sort");
        kept.save(this.name, {column, order, isOpen: this.details.open});
    }

    restore() {
        const {column, order, isOpen} = kept.load(this.name);
        if (isOpen !== undefined) this.details.open = isOpen;
        const header = this.headers[column];
        const isThere = () => header === undefined || header.getAttribute("aria-sort") === order;
        for (let clicks = 0; clicks < 2 && !isThere(); ++clicks) this.sortBy(column);
    }

    // Cells without a number come last in ascending order.
    compare(a, b) {
        if (a.tagName === "TH")
            return a.textContent.localeCompare(b.textContent, "en", {numeric: true});
        const [x, y] = [a, b].map((cell) => Number(cell.dataset.value ?? Infinity));
        return x === y ? 0 : x - y;
    }

    filter(rowText, columnText) {
        const has = (text, part) => text.toLowerCase().includes(part.toLowerCase());
        const isShown = this.headers.map(
            (header, column) => column < this.nLabels || has(header.textContent, columnText));
        this.headers.forEach((header, column) => {
            header.hidden = !isShown[column];
        });
        for (const row of this.original) {
            const labels = [...row.cells].slice(0, this.nLabels).map((label) => label.textContent);
            row.hidden = !has(labels.join(" "), rowText);
            [...row.cells].forEach((cell, column) => {
                cell.hidden = !isShown[column];
            });
        }
    }
}

// Its image, below.
function showCell(cell) {
    const scene = report.scenes.findIndex(({name}) => name === cell.scene);
    viewer.set({
        scene,
        method: report.methods.indexOf(cell.method) + 1,
        budget: report.budgets.indexOf(cell.budget),
    });
    charts.set({scene});
    document.getElementById("images").scrollIntoView();
}

function makeTables() {
    const tables = [...document.querySelectorAll("#results details")].map(
        (details) => new ResultTable(details, report.metrics[details.dataset.metric]));
    const [rows, columns] =
        ["row-filter", "column-filter"].map((id) => document.getElementById(id));
    const filter = () =>
        tables.forEach((table) => table.filter(rows.value.trim(), columns.value.trim()));
    for (const input of [rows, columns]) input.addEventListener("input", filter);
    window.addEventListener("pageshow", filter);  // a reload keeps what fields hold
    if (tables.length > 1) {
        document.getElementById("metric-picks").append("metrics ", ...tables.map((table, i) => {
            const box = element("input", {
                type: "checkbox",
                change: () => {
                    table.details.hidden = !box.checked;
                }
            });
            box.checked = true;
            return element("label", {}, box, ` ${report.metrics[i].metric}`);
        }));
    }
    return tables;
}
