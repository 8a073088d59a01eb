// Shows one method and budget at a time, in all scenes at once, where the last one was.
"use strict";
(() => {
    const images = document.getElementById("images");
    const figures = [...images.querySelectorAll("figure")];
    const unique = (values) => [...new Set(values)];
    const methods = unique(figures.map((f) => f.dataset.method));
    const budgets = unique(figures.map((f) => f.dataset.budget).filter((b) => b !== ""));
    if (methods.length === 0) return;

    // Method 0 is the reference, which is the same for every budget.
    let picked = { method: methods.length > 1 ? 1 : 0, budget: 0 };
    let before = { method: 0, budget: 0 };

    const isShown = (figure) =>
        figure.dataset.method === methods[picked.method] &&
        (figure.dataset.budget === "" || figure.dataset.budget === budgets[picked.budget]);

    function update() {
        for (const figure of figures) figure.classList.toggle("shown", isShown(figure));
        for (const button of images.querySelectorAll("nav button")) {
            const isPicked = button.dataset.method !== undefined
                ? button.dataset.method === methods[picked.method]
                : button.dataset.budget === budgets[picked.budget];
            button.classList.toggle("picked", isPicked);
        }
    }

    function pick(change) {
        const next = { ...picked, ...change };
        if (next.method === picked.method && next.budget === picked.budget) return;
        before = picked;
        picked = next;
        update();
    }

    const step = (from, by, length) => (from + by + length) % length;

    images.addEventListener("click", (event) => {
        const button = event.target.closest("nav button");
        if (button && button.dataset.method !== undefined) {
            pick({ method: methods.indexOf(button.dataset.method) });
        } else if (button) {
            pick({ budget: budgets.indexOf(button.dataset.budget) });
        } else if (event.target.tagName === "IMG") {
            pick(before);
        }
    });

    document.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.altKey || event.metaKey) return;
        const number = "0123456789".indexOf(event.key);
        if (number >= 0 && number < methods.length) pick({ method: number });
        else if (event.key === "ArrowRight") pick({ method: step(picked.method, 1, methods.length) });
        else if (event.key === "ArrowLeft") pick({ method: step(picked.method, -1, methods.length) });
        else if (event.key === "ArrowDown" && budgets.length > 1) {
            pick({ budget: step(picked.budget, 1, budgets.length) });
        } else if (event.key === "ArrowUp" && budgets.length > 1) {
            pick({ budget: step(picked.budget, -1, budgets.length) });
        } else return;
        event.preventDefault();
    });

    document.querySelector(".budget-hint").hidden = budgets.length < 2;
    document.body.classList.add("switching");
    update();
})();
