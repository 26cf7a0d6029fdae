// SPDX-License-Identifier: GPL-3.0-or-later
// Small helpers for building the page, and its icons (drawn for this page, 24 x 24).

/** h("div", {class: "x", onclick: f}, child, "text", …) */
export function h(tag, attributes = {}, ...children) {
    const element = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes)) {
        if (value === null || value === undefined || value === false) continue;
        if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
        else if (key === "html") element.innerHTML = value;
        else if (key in element && typeof value !== "string") element[key] = value;
        else element.setAttribute(key, value === true ? "" : value);
    }
    element.append(...children.flat().filter((c) => c !== null && c !== undefined));
    return element;
}

const paths = {
    play: "M7 4.5v15l12-7.5z",
    pause: "M7 5h3.5v14H7zM13.5 5H17v14h-3.5z",
    first: "M6 5h2.4v14H6zM19 5v14L9 12z",
    last: "M15.6 5H18v14h-2.4zM5 5v14l10-7z",
    back: "M15.5 5v14L6 12z",
    next: "M8.5 5v14L18 12z",
    loop: "M12 5V2.2L16.6 6 12 9.8V7a5 5 0 1 0 5 5h2a7 7 0 1 1-7-7z",
    eye: "M12 5C6.5 5 2.6 9.6 1.5 12c1.1 2.4 5 7 10.5 7s9.4-4.6 10.5-7C21.4 9.6 17.5 5 12 5zm0 11.4a4.4 4.4 0 1 1 0-8.8 4.4 4.4 0 0 1 0 8.8zm0-2.2a2.2 2.2 0 1 0 0-4.4 2.2 2.2 0 0 0 0 4.4z",
    hidden: "M3.3 2 2 3.3l4 4C3.700 8.800 2.200 10.800 1.500 12c1.100 2.400 5 7 10.500 7 1.900 0 3.600-.5 5-1.300l3.700 3.700 1.300-1.300zM12 16.400a4.400 4.400 0 0 1-4-6.200l1.700 1.700a2.200 2.200 0 0 0 2.300 2.300l1.800 1.800c-.6.300-1.200.400-1.800.400zM12 5c-1.200 0-2.300.2-3.300.6l2.100 2.100A4.400 4.400 0 0 1 16.300 13l3 3c1.600-1.400 2.700-3 3.200-4C21.400 9.600 17.500 5 12 5z",
    solo: "M12 3a9 9 0 1 0 0 18 9 9 0 0 0 0-18zm0 2.200a6.800 6.800 0 1 1 0 13.600 6.800 6.800 0 0 1 0-13.600zM12 9a3 3 0 1 0 0 6 3 3 0 0 0 0-6z",
    sun: "M12 7.500a4.500 4.500 0 1 0 0 9 4.500 4.500 0 0 0 0-9zM11 1.500h2v3.500h-2zM11 19h2v3.500h-2zM1.500 11H5v2H1.500zM19 11h3.500v2H19zM3.900 5.300l1.400-1.400 2.500 2.500-1.400 1.400zM16.200 17.600l1.400-1.400 2.500 2.500-1.400 1.400zM3.900 18.700l2.500-2.500 1.400 1.400-2.500 2.500zM16.200 6.400l2.500-2.500 1.400 1.400-2.500 2.500z",
    moon: "M20 14.600A8.500 8.500 0 0 1 9.400 4a8.500 8.500 0 1 0 10.600 10.600z",
    help: "M12 2a10 10 0 1 0 0 20 10 10 0 0 0 0-20zm-1.100 14.800h2.200V19h-2.200zM12 5a4 4 0 0 0-4 4h2.100a1.900 1.900 0 1 1 2.700 1.700c-1.100.6-1.900 1.400-1.900 3v1.400H13v-1.200c0-.8.300-1.200 1.100-1.700A4 4 0 0 0 12 5z",
    camera: "M9 4 7.500 6H4a2 2 0 0 0-2 2v10a2 2 0 0 0 2 2h16a2 2 0 0 0 2-2V8a2 2 0 0 0-2-2h-3.500L15 4zm3 5a4 4 0 1 1 0 8 4 4 0 0 1 0-8zm0 2a2 2 0 1 0 0 4 2 2 0 0 0 0-4z",
    focus: "M3 3h6v2H5v4H3zM15 3h6v6h-2V5h-4zM3 15h2v4h4v2H3zM19 15h2v6h-6v-2h4zM12 8.500a3.500 3.500 0 1 1 0 7 3.500 3.500 0 0 1 0-7z",
    grow: "M12 3 5.500 9.500 7 11 12 6 17 11 18.500 9.500zM12 21l6.500-6.500L17 13l-5 5-5-5-1.500 1.500z",
    down: "M5 8.500 12 15.500 19 8.500 17.500 7 12 12.500 6.500 7z",
    menu: "M3 5.500h18v2H3zM3 11h18v2H3zM3 16.500h18v2H3z",
    close: "M6.400 5 5 6.400 10.600 12 5 17.600 6.400 19 12 13.400 17.600 19 19 17.600 13.400 12 19 6.400 17.600 5 12 10.600z",
    warning: "M12 2.500 1.500 21h21zm-1 6.500h2v6h-2zm0 8h2v2h-2z",
};

export const icon = (name) =>
    `<svg class="icon" viewBox="0 0 24 24" aria-hidden="true"><path fill="currentColor" fill-rule="evenodd" d="${paths[name]}"/></svg>`;

export function iconButton(name, title, onclick, extra = {}) {
    return h("button", { type: "button", class: "icon-button", title, "aria-label": title, onclick, html: icon(name), ...extra });
}

export function toggle(label, onchange, hint = "") {
    const input = h("input", { type: "checkbox", onchange: () => onchange(input.checked) });
    const element = h("label", { class: "toggle" }, input, h("span", { class: "switch" }), h("span", { class: "label" }, label),
        hint ? h("kbd", {}, hint) : null);
    return { element, input };
}

/** Numbers for people: three or four digits. */
export function show(value, digits = 3) {
    if (value === null || value === undefined || !Number.isFinite(value)) return "–";
    const size = Math.abs(value);
    if (size === 0) return "0";
    if (size >= 1e5 || size < 1e-3) return value.toExponential(1).replace("e+", "e").replace("-", "−");
    return String(Number(value.toPrecision(digits))).replace("-", "−");
}

export const count = (n) => n.toLocaleString("en-US");
