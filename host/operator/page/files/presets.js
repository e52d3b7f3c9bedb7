// SPDX-License-Identifier: Apache-2.0
// Presets: stored, recalled, compared with what is shown.
'use strict';

const preset_path = name => thing_path('presets', name);

function makePreset(p) {
  const button = (label, onclick, text) => field(label, p.name, make('button', { onclick }, text));
  return make('div', { className: 'thing' }, make('b', {}, p.name),
    make('details', {}, make('summary', {}), make('ul', {})),
    make('div', { className: 'row' },
      button('recall', async () => { if (await ask('POST', preset_path(p.name) + '/recall')) note(`Recalled ${p.name}.`, true); }, 'Recall'),
      button('store again', () => confirm(`Replace the preset ${p.name} by what is shown?`) &&
        ask('PUT', preset_path(p.name), { replace: true }), 'Store again'),
      button('remove preset', () => confirm(`Remove the preset ${p.name}?`) &&
        ask('DELETE', preset_path(p.name)), 'Remove')));
}
function updatePreset(block, p) {
  const count = p.differences.length;
  block.dataset.differs = count > 0;
  set(block.querySelector('summary'), 'textContent',
    count ? `${count} difference${count > 1 ? 's' : ''} to what is shown` : 'as it is shown');
  const text = p.differences.join('\n'), list = block.querySelector('ul');
  if (list.dataset.text === text) return;
  list.dataset.text = text;
  list.replaceChildren(...p.differences.map(one => make('li', {}, one)));
}
function showPresets(list) { showThings('presets', list, makePreset, updatePreset); }

el('preset-store').addEventListener('click', async () => {
  const name = el('preset-name').value.trim();
  if (!name) return tell('Give the preset a name first.');
  if (!await ask('PUT', preset_path(name), {})) return;
  el('preset-name').value = '';
  note(`Stored ${name}.`);
});
