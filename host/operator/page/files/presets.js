// SPDX-License-Identifier: Apache-2.0
// Presets: stored, recalled, compared with what is shown.
'use strict';

const preset_path = name => thing_path('presets', name);

function makePreset(p) {
  const button = (label, onclick, text) => field(label, p.name, make('button', { onclick }, text));
  return make('div', { className: 'thing' }, make('b', {}, p.name),
    make('details', {}, make('summary', {}), make('ul', {})),
    make('div', { className: 'row' },
      button('recall', async () => { if (await ask('POST', preset_path(p.name) + '/recall')) note(tr`Recalled ${p.name}.`, true); }, tr`Recall`),
      button('store again', () => confirm(tr`Replace the preset ${p.name} by what is shown?`) &&
        ask('PUT', preset_path(p.name), { replace: true }), tr`Store again`),
      button('remove preset', () => confirm(tr`Remove the preset ${p.name}?`) &&
        ask('DELETE', preset_path(p.name)), tr`Remove`)));
}
function updatePreset(block, p) {
  const count = p.differences.length;
  block.dataset.differs = count > 0;
  set(block.querySelector('summary'), 'textContent',
    count === 0 ? tr`as it is shown` : count === 1 ? tr`1 difference to what is shown` : tr`${count} differences to what is shown`);
  const text = p.differences.join('\n'), list = block.querySelector('ul');
  if (list.dataset.text === text) return;
  list.dataset.text = text;
  list.replaceChildren(...p.differences.map(one => make('li', {}, one)));
}
function showPresets(list) { showThings('presets', list, makePreset, updatePreset); }

el('preset-store').addEventListener('click', async () => {
  const name = el('preset-name').value.trim();
  if (!name) return tell(tr`Give the preset a name first.`);
  if (!await ask('PUT', preset_path(name), {})) return;
  el('preset-name').value = '';
  note(tr`Stored ${name}.`);
});
