// Redraw a live picture in place: what the reader has opened stays open and keeps the focus.

const BOXES = '[role="group"]'; // the drawing and its table, see drawing/svg.py

function redraw(picture, newer) {
  const boxes = picture.querySelectorAll(BOXES);
  for (const [n, box] of newer.querySelectorAll(BOXES).entries()) {
    boxes[n].setAttribute('aria-label', box.getAttribute('aria-label'));
    boxes[n].replaceChildren(...box.childNodes);
  }
}

function initialize({ model }) {
  const shown = new Map(); // the picture in each view of its cell, by its parent
  const outputs = new MutationObserver(find);
  let focused = null;

  function find() {
    for (const picture of document.querySelectorAll(`[data-picture="${model.get('place')}"]`)) {
      const parent = picture.parentElement;
      const before = shown.get(parent);
      if (!before) {
        shown.set(parent, picture);
        outputs.observe(parent, { childList: true });
        parent.addEventListener('focusin', (event) => { focused = event.target; });
      } else if (before !== picture) {
        // The notebook has received the newest picture, and the page has inserted it.
        redraw(before, picture);
        picture.replaceWith(before);
        const lost = document.activeElement === document.body && before.contains(focused);
        if (lost) focused.focus({ preventScroll: true });
      }
    }
  }

  function draw() {
    find();
    for (const picture of shown.values()) {
      const newer = document.createElement('template');
      newer.innerHTML = model.get('picture');
      redraw(picture, newer.content);
    }
  }

  draw();
  model.on('change:picture', draw);
  if (shown.size > 0) model.send('shown');
}

export default { initialize };
