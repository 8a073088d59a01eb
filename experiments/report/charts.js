// Charts of one scene: error by method, error over effort, and what error costs.

const kPalette = [
    "#3b6fb6", "#d1622b", "#3a8f4f", "#b23a48", "#7a5aa6", "#8a6b3d", "#c65f9e", "#5e6a75",
    "#9a9a1f", "#1f98a6"
];
const kMarks = ["circle", "triangle", "rect", "rectRot"];  // where colors come again
const markOfMethod = (method) =>
    kMarks[Math.floor(report.methods.indexOf(method) / kPalette.length) % kMarks.length];
const colorOfMethod = (method) => kPalette[report.methods.indexOf(method) % kPalette.length];

// Of points {low, high} of the datasets: a line from one to the other.
const intervalLines = {
    id: "intervalLines",
    beforeDatasetsDraw(chart) {
        const {ctx, chartArea: area, scales} = chart;
        ctx.save();
        ctx.beginPath();
        ctx.rect(area.left, area.top, area.width, area.height);
        ctx.clip();
        chart.data.datasets.forEach((dataset, d) => {
            if (!chart.isDatasetVisible(d)) return;
            chart.getDatasetMeta(d).data.forEach((point, i) => {
                const {low, high} = dataset.data[i];
                if (low === undefined) return;
                const ends =
                    [low, high].map((v) => scales.y.getPixelForValue(Math.max(v, scales.y.min)));
                ctx.strokeStyle = dataset.pointBackgroundColor?.[i] ?? dataset.borderColor;
                ctx.lineWidth = 1.5;
                ctx.beginPath();
                for (const y of ends) {
                    ctx.moveTo(point.x - 4, y);
                    ctx.lineTo(point.x + 4, y);
                }
                ctx.moveTo(point.x, ends[0]);
                ctx.lineTo(point.x, ends[1]);
                ctx.stroke();
            });
        });
        ctx.restore();
    },
};

const kEfforts = {
    cpu_seconds: "CPU seconds",
    wall_seconds: "wall seconds",
    passes: "samples per pixel"
};

// Of imported images often not all are known.
const knownEfforts = () => Object.keys(kEfforts).filter(
    (effort) => report.metrics.some(({cells}) => cells.some((cell) => cell[effort] > 0)));

// Where a logarithmic axis is marked: at even steps within less than a decade, else at 1, 2 and 5
// times powers of ten, over many decades at those powers alone.
function logTicks(min, max) {
    const decades = Math.log10(max / min);
    const ticks = [];
    if (decades < 0.8) {
        const rough = (max - min) / 5;
        const power = 10 ** Math.floor(Math.log10(rough));
        const size = power * [1, 2, 5, 10].find((m) => m * power >= rough);
        for (let i = Math.ceil(min / size); i * size <= max; ++i) ticks.push(i * size);
        return ticks;
    }
    for (let e = Math.floor(Math.log10(min)); 10 ** e <= max; ++e) {
        for (const mantissa of decades < 4 ? [1, 2, 5] : [1]) {
            const value = mantissa * 10 ** e;
            if (value >= min && value <= max) ticks.push(value);
        }
    }
    return ticks;
}

function tickText(value) {
    const rounded = Number(value.toPrecision(3));
    return rounded < 1e-3 || rounded >= 1e5 ? rounded.toExponential() : String(rounded);
}

class Charts {
    constructor(tools, grid) {
        this.efforts = knownEfforts();
        this.state = {scene: 0, metric: 0, budget: 0, effort: this.efforts[0] ?? "cpu_seconds"};
        this.charts = [];
        this.grid = grid;
        const choose = (label, names, key, values) => {
            if (names.length < 2) return;
            const select = element("select", {
                change: () =>
                    this.set({[key]: values ? values[select.selectedIndex] : select.selectedIndex}),
            },
                ...names.map((text) => element("option", {text})));
            tools.append(element("label", {}, `${label} `, select));
            this.selects[key] = select;
        };
        this.selects = {};
        choose("scene", report.scenes.map((s) => s.name), "scene");
        choose("metric", report.metrics.map((m) => m.metric), "metric");
        choose("budget", report.budgets, "budget");
        choose("effort", this.efforts.map((key) => kEfforts[key]), "effort", this.efforts);
        this.restore();
        this.draw();
    }

    restore() {
        const {scene, metric, budget, effort} = kept.load("charts");
        const isThere = scene < report.scenes.length && metric < report.metrics.length &&
            budget < report.budgets.length && this.efforts.includes(effort);
        if (isThere) this.state = {scene, metric, budget, effort};
        const {selects, state} = this;
        for (const [key, select] of Object.entries(selects)) {
            select.selectedIndex =
                key === "effort" ? this.efforts.indexOf(state.effort) : state[key];
        }
    }

    set(change) {
        Object.assign(this.state, change);
        if (change.scene !== undefined && this.selects.scene)
            this.selects.scene.selectedIndex = change.scene;
        kept.save("charts", this.state);
        this.draw();
    }

    draw() {
        for (const chart of this.charts) chart.destroy();
        this.charts = [];
        this.grid.replaceChildren();
        const metric = report.metrics[this.state.metric];
        const scene = report.scenes[this.state.scene].name;
        const budget = report.budgets[this.state.budget];
        const cells = metric.cells.filter(
            (cell) => cell.scene === scene && cell.budget === budget && cell.mean);
        const curves = metric.curves.filter((curve) => curve.scene === scene);
        const effort = kEfforts[this.state.effort];
        if (cells.length > 0) {
            const front = metric.better === "none" ?
                "" :
                "; the line joins those that no other method beats in both";
            this.add(`${metric.metric} by method, ${budget}`, this.byMethod(cells));
            // At one effort of all it would say nothing more.
            const spent = cells.filter((cell) => cell[this.state.effort] > 0);
            if (new Set(spent.map((cell) => cell[this.state.effort])).size > 1) {
                this.add(
                    `${metric.metric} over ${effort}, ${budget}${front}`, this.tradeoff(spent));
            }
        }
        if (curves.some((curve) => curve.points.length > 1)) {
            const title = `${metric.metric} over ${effort}, all budgets`;
            this.add(title, this.convergence(curves));
        }
        if (this.charts.length === 0)
            this.grid.append(element("p", {text: "Nothing is measured here yet."}));
    }

    point(x, estimate, label) {
        const [low, high] = estimate.interval ?? [];
        return {x, y: estimate.value, low, high, label};
    }

    // A length on a logarithmic axis would depend on where it starts: so marks, not bars.
    byMethod(cells) {
        return {
            legend: false,
            x: {labels: cells.map((cell) => cell.method)},
            datasets: [{
                data: cells.map((cell) => this.point(cell.method, cell.mean, cell.method)),
                showLine: false,
                pointBackgroundColor: cells.map((cell) => colorOfMethod(cell.method)),
                pointBorderColor: cells.map((cell) => colorOfMethod(cell.method)),
            }],
        };
    }

    tradeoff(cells) {
        const {effort} = this.state;
        const direction = report.metrics[this.state.metric].better;
        const better = (a, b) => (direction === "less" ? a.y < b.y : a.y > b.y);
        const datasets = cells.map((cell) => ({
            label: cell.method,
            data: [this.point(cell[effort], cell.mean, cell.method)],
            showLine: false,
        }));
        if (direction === "none") return {x: {title: kEfforts[effort]}, datasets};
        const points = datasets.map((dataset) => dataset.data[0]);
        const front =
            points.filter((p) => !points.some((q) => q !== p && q.x <= p.x && better(q, p)))
                .sort((a, b) => a.x - b.x);
        datasets.push({
            label: "front",
            data: front.map(({x, y}) => ({x, y})),
            isFront: true,
            pointRadius: 0,
            pointHitRadius: 0,
            borderDash: [4, 4],
            borderWidth: 1,
        });
        return {x: {title: kEfforts[effort]}, datasets};
    }

    convergence(curves) {
        const {effort} = this.state;
        return {
            x: {title: kEfforts[effort]},
            datasets: curves.map((curve) => ({
                label: curve.method,
                data: curve.points.map((p) => this.point(p[effort], p, curve.method)),
                showLine: true,
            })),
        };
    }

    add(title, {legend = true, x, datasets}) {
        const style = getComputedStyle(document.documentElement);
        const [ink, line, faint] =
            ["--ink", "--line", "--faint"].map((name) => style.getPropertyValue(name).trim());
        for (const dataset of datasets) {
            const color = dataset.isFront ? faint : colorOfMethod(dataset.label);
            Object.assign(dataset, {
                borderColor: color,
                backgroundColor: color,
                pointStyle: markOfMethod(dataset.label),
                pointRadius: 4,
                borderWidth: 1.5,
                ...dataset
            });
        }
        const axis = (extra) =>
            ({grid: {color: line, borderColor: faint}, ticks: {color: ink}, ...extra});
        // Wide enough for what the datasets have, with a margin. `ends` may lie at or below zero
        // where no value does: such an interval leaves the chart.
        const logarithmic = (values, ends, extra = {}) => {
            if (values.some((value) => value <= 0)) return axis({type: "linear", ...extra});
            const positive = [...values, ...ends].filter((value) => value > 0);
            return axis({
                type: "logarithmic",
                min: Math.min(...positive) / 1.15,
                max: Math.max(...positive) * 1.15,
                afterBuildTicks: (scale) => {
                    scale.ticks = logTicks(scale.min, scale.max).map((value) => ({value}));
                },
                ticks: {color: ink, callback: tickText},
                ...extra,
            });
        };
        const points = datasets.flatMap((dataset) => dataset.data);
        const xAxis = x.labels ? axis({type: "category", offset: true}) :
                                 logarithmic(points.map((p) => p.x), [],
                                     {title: {display: true, text: x.title, color: ink}});
        const yAxis = logarithmic(points.map((p) => p.y), points.flatMap((p) => [p.low, p.high]));
        const canvas = element("canvas");
        this.grid.append(element(
            "figure", {}, element("figcaption", {text: title}), element("div", {}, canvas)));
        this.charts.push(new Chart(canvas, {
            type: "line",
            data: {labels: x.labels, datasets},
            plugins: [intervalLines],
            options: {
                animation: false,
                maintainAspectRatio: false,
                scales: {x: xAxis, y: yAxis},
                plugins: {
                    legend: {
                        display: legend,
                        labels: {
                            color: ink,
                            boxWidth: 10,
                            boxHeight: 10,
                            filter: ({text}) => text !== "front"
                        },
                    },
                    tooltip: {
                        filter: ({dataset}) => !dataset.isFront,
                        callbacks: {title: () => "", label: ({raw}) => tellPoint(raw)},
                    },
                },
            },
        }));
    }
}

function tellPoint({x, y, low, high, label}) {
    const at = typeof x === "number" ? ` at ${precise(x)}` : "";
    const interval = low === undefined ? "" : ` [${precise(low)}, ${precise(high)}]`;
    return `${label}${at}: ${precise(y)}${interval}`;
}
