// Redraw a live picture in place: what the reader has opened stays open and keeps the focus.

const BOXES = '[role="group"]'; // the drawing and its table, see drawing/svg.py

function redraw(picture, html) {
  const newer = document.createRange().createContextualFragment(html);
  const boxes = picture.querySelectorAll(BOXES);
  for (const [n, box] of newer.querySelectorAll(BOXES).entries()) {
    boxes[n].setAttribute('aria-label', box.getAttribute('aria-label'));
    boxes[n].replaceChildren(...box.childNodes);
  }
}

function initialize({ model }) {
  const shown = new WeakMap(); // the picture, by its parent
  const outputs = new MutationObserver(draw);
  let focused;

  function draw() {
    for (const found of document.querySelectorAll(`[data-picture="${model.get('place')}"]`)) {
      const parent = found.parentElement;
      if (!shown.has(parent)) {
        shown.set(parent, found);
        outputs.observe(parent, { childList: true });
        model.send('shown');
      }
      const kept = shown.get(parent);
      redraw(kept, model.get('picture'));
      if (kept === found) continue;
      found.replaceWith(kept); // the page has inserted what the notebook received
      const isLost = document.activeElement === document.body && kept.contains(focused);
      if (isLost) focused.focus({ preventScroll: true });
    }
    focused = document.activeElement;
  }

  model.on('change:picture', draw);
  draw();
}

export default { initialize };
