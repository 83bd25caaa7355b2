// Lists of cards and rows: built anew only when what they show has changed, so that a finger never presses one that is just being replaced.
export function showList(box, items, build, context = "") {
  const key = JSON.stringify([items, document.documentElement.lang, context]);
  if (box.dataset.list === key) return;
  box.dataset.list = key;
  box.replaceChildren(...items.map(build));
}
