// The page's parts, and what joins them.

const viewer = new Viewer(document.getElementById("viewer"));
const tables = makeTables();
const charts =
    new Charts(document.getElementById("chart-tools"), document.getElementById("chart-grid"));

document.querySelector(".claims-link").hidden = document.getElementById("claims") === null;
document.getElementById("contents").addEventListener("click", ({target}) => {
    if (target.dataset.scene !== undefined) {
        const scene = Number(target.dataset.scene);
        viewer.set({scene});
        charts.set({scene});
    } else if (target.dataset.method !== undefined) {
        viewer.set({method: Number(target.dataset.method) + 1});
    }
});
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => charts.draw());
viewer.restore();

// While the experiment runs, the file is written anew. Nobody is interrupted while dragging.
if (report.running !== null) {
    const {tasks, done, failed, reload_seconds: seconds} = report.running;
    document.title = `${Math.floor((100 * done) / tasks)} % ${document.title}`;
    const count = `${done} of ${tasks} tasks done${failed > 0 ? `, ${failed} failed` : ""}`;
    const time = new Date(document.lastModified).toLocaleTimeString();
    document.body.classList.add("unfinished");
    document.querySelector("header").append(element("p", {class: "running"},
        element("progress", {max: tasks, value: done + failed}),
        ` running: ${count} at ${time}; errors are of what is done; loads again every ${seconds} s`));
    setInterval(() => {
        if (!viewer.drag && !document.hidden) window.location.reload();
    }, 1000 * seconds);
}
