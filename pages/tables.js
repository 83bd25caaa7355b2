// Tables. A head is a list of titles; a row a list of cells, { group: title } or { note: text }, or { cells, silent }. A title or cell is a text, a
// number, a Node, or { text } that is read rather than compared, and stands to the left.
function cell(tag, content) {
  const isText = content !== null && typeof content === "object" && !(content instanceof Node);
  const made = element(tag, isText ? { class: "text" } : {});
  const parts = isText ? [].concat(content.text) : [content];
  parts.forEach((part, k) => {
    if (k) made.append(element("br"));
    made.append(typeof part === "number" || part === null || part === undefined ? number(part) : part);
  });
  return made;
}

function table(head, rows) {
  const body = element("tbody");
  for (const row of rows) {
    const whole = row.group ?? row.note;
    if (whole !== undefined) {
      const one = element("tr", { class: row.group !== undefined ? "group" : "note" });
      one.append(element("td", { colspan: head.length }, whole));
      body.append(one);
    } else {
      const cells = (row.cells ?? row).map((content) => cell("td", content));
      while (cells.length < head.length) cells.push(element("td"));
      body.append(element("tr", row.silent ? { class: "silent" } : {}, ...cells));
    }
  }
  const top = element("thead", {}, element("tr", {}, ...head.map((title) => cell("th", title))));
  return add(element("div", { class: "wide" }, element("table", {}, top, body)));
}

const axesHead = (first, axes) => [first, ...each(axes, axisName)];
