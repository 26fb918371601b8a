// A multiple-choice question. Strings never become HTML: they only go into text nodes.

// JupyterLab looks for this attribute on the focused element; without it, JupyterLab would handle
// the arrow keys itself and move between cells.
const KEEP_KEYS = 'data-lm-suppress-shortcuts';
const MODIFIERS = ['Control', 'Meta', 'Alt', 'Shift'];

function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

// 'a `b` c' -> text, <code>, text
function withCode(text) {
  return text
    .split('`')
    .map((part, n) => (n % 2 ? element('code', {}, part) : document.createTextNode(part)))
    .filter((node) => node.textContent !== '');
}

function render({ model, el }) {
  const { text, options } = model.get('question');
  // Every widget has a separate copy of this module, so a counter would start again with each
  // question. Questions with equal names would form one group: arrow keys would leave a question.
  const group = `roslab-quiz-${Math.random().toString(36).slice(2)}`;
  const status = element('div', { role: 'status', 'aria-live': 'polite', class: 'roslab-quiz-why' });
  const fieldset = element('fieldset', { class: 'roslab-quiz' });
  fieldset.append(element('legend', {}, ...withCode(text)));
  let byArrow = false; // an arrow key moves the selection; only Enter or Space answers

  const inputs = options.map((option, n) => {
    const input = element('input', {
      type: 'radio',
      name: group,
      value: String(n),
      [KEEP_KEYS]: 'true',
    });
    input.addEventListener('keydown', (event) => {
      // Leave Ctrl+S, Shift+Enter and similar keys to JupyterLab.
      if (MODIFIERS.includes(event.key)) input.removeAttribute(KEEP_KEYS);
      if (event.ctrlKey || event.altKey || event.metaKey || event.shiftKey) return;
      byArrow = event.key.startsWith('Arrow');
      if (event.key !== 'Enter' && event.key !== ' ') return;
      event.preventDefault();
      input.checked = true;
      answer(n);
    });
    input.addEventListener('keyup', (event) => {
      byArrow = false;
      if (MODIFIERS.includes(event.key)) input.setAttribute(KEEP_KEYS, 'true');
    });
    input.addEventListener('focus', () => input.setAttribute(KEEP_KEYS, 'true'));
    input.addEventListener('click', () => {
      if (byArrow) hint();
      else answer(n);
    });
    const letter = element('span', { class: 'roslab-quiz-letter' }, `${'abcd'[n]})`);
    const words = element('span', {}, ...withCode(option.text));
    fieldset.append(element('label', {}, input, letter, words));
    return input;
  });

  function mark(n, name) {
    for (const [other, input] of inputs.entries()) {
      if (other === n) input.parentElement.dataset.answer = name;
      else delete input.parentElement.dataset.answer;
    }
  }

  function hint() {
    mark(-1, '');
    status.className = 'roslab-quiz-why';
    status.replaceChildren('Press Enter or Space to answer.');
  }

  function answer(n) {
    model.set('chosen', n);
    model.save_changes();
    explain(n);
  }

  function explain(n) {
    const { right, why } = options[n];
    mark(n, right ? 'right' : 'wrong');
    status.className = `roslab-quiz-why ${right ? 'right' : 'wrong'}`;
    const verdict = element('strong', {}, right ? '\u2713 Right. ' : '\u2717 Not right. ');
    const again = right ? [] : [element('em', {}, ' Try another one.')];
    status.replaceChildren(verdict, ...withCode(why), ...again);
  }

  el.append(fieldset, status);
  // The page may draw the same question again; keep the answer given before.
  if (model.get('chosen') >= 0) {
    inputs[model.get('chosen')].checked = true;
    explain(model.get('chosen'));
  }
}

export default { render };
