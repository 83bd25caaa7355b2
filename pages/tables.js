// Tables. A head is a list of titles; a row a list of cells, { group: title }, { note: text or texts }, or { cells, silent }. A title or cell is a
// text, a number, a Node, or { text }, a text or texts that are read rather than compared, and stand to the left.
function cell(tag, content) {
  const isText = content !== null && typeof content === "object" && !(content instanceof Node);
  if (isText) return lines(element(tag, { class: "text" }), content.text);
  return element(tag, {}, typeof content === "number" || content === null || content === undefined ? number(content) : content);
}

// One text, or several below each other.
function lines(into, texts) {
  [].concat(texts).forEach((text, k) => into.append(...(k ? [element("br")] : []), text));
  return into;
}

function table(head, rows) {
  const body = element("tbody");
  for (const row of rows) {
    const whole = row.group ?? row.note;
    if (whole !== undefined) {
      body.append(element("tr", { class: row.group !== undefined ? "group" : "note" }, lines(element("td", { colspan: head.length }), whole)));
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
