// SPDX-License-Identifier: Apache-2.0
// The slate: the name of the next take by scene and shot, counted; recording; the list of takes.
'use strict';

const taken = () => new Set((state.takes || []).map(one => one.name.replace(/\.partial$/, '')));

// "A", "A take 2", ...; a name that ends in a number is counted on.
function freeTake(wanted) {
  const names = taken(), found = wanted.match(/^(.*\btake )(\d+)$/);
  if (!found && !names.has(wanted)) return wanted;
  const stem = found ? found[1] : wanted + ' take ';
  let number = found ? Number(found[2]) : 2;
  while (names.has(stem + number)) ++number;
  return stem + number;
}
function proposed() {
  const slate = [el('slate-scene').value.trim(), el('slate-shot').value.trim()].filter(Boolean).join('-');
  return freeTake(slate ? `${slate} take 1` : 'take 1');
}
function showSlate() {
  const r = state.recording;
  el('take-name').placeholder = proposed();
  if (!r || r.on || !el('take-name').dataset.last || el('take-name').value !== el('take-name').dataset.last) return;
  el('take-name').value = freeTake(el('take-name').value);   // the name that was recorded last is counted on
  el('take-name').dataset.last = '';
}
for (const id of ['slate-scene', 'slate-shot']) el(id).addEventListener('input', showSlate);

async function startRecording() {
  const own = el('take-name').value.trim();
  if (own && taken().has(own)) {
    el('take-name').value = freeTake(own);
    return tell(tr`${own} exists. The next is ${el('take-name').value}: press Record for it, or give another name.`);
  }
  const name = own || proposed();
  if (await ask('POST', 'record/start', { name, notes: el('take-notes').value }) && own) el('take-name').dataset.last = own;
}
el('record').addEventListener('click', () => state.recording && state.recording.on ? ask('POST', 'record/stop') : startRecording());

function makeTake(t) {
  const put = body => ask('PUT', thing_path('takes', t.name), body);
  const circle = field('circle', t.name, make('button', { className: 'circle', title: tr`Mark as a good take`,
    onclick: e => put({ circled: e.currentTarget.getAttribute('aria-pressed') !== 'true' }) }));
  const play = field('play', t.name, make('button', { onclick: () => Player.open(state.takes.find(one => one.name === t.name)) }, tr`Play`));
  const notes = field('notes', t.name, make('input', { type: 'text', maxLength: 1000, placeholder: tr`notes`,
    onchange: e => put({ notes: e.target.value }) }));
  return make('div', { className: 'thing take' }, circle,
    make('div', {}, make('b', {}, t.name), make('p', { className: 'hint' }), notes), play);
}
const take_states = { 'whole': tr`whole`, 'cut off': tr`cut off` };
function updateTake(block, t) {
  const whole = t.frames > 0;
  const size = t.megabytes >= 1000 ? `${(t.megabytes / 1000).toFixed(1)} GB` : `${t.megabytes.toFixed(1)} MB`;
  const words = [whole ? clock_text(t.seconds) : '', whole ? tr`${t.frames} frames` : '', t.lost ? tr`${t.lost} lost` : '', size, take_states[t.state] || t.state];
  set(block.querySelector('.hint'), 'textContent', words.filter(Boolean).join(', '));
  block.querySelector('.hint').classList.toggle('bad', t.state !== 'whole');
  const circle = part(block, 'circle');
  circle.setAttribute('aria-pressed', t.circled);
  set(circle, 'textContent', t.circled ? '\u25c9' : '\u25cb');
  circle.disabled = part(block, 'notes').disabled = part(block, 'play').disabled = !whole;
  setValue(part(block, 'notes'), t.notes);
}
function showTakes(list) {
  showThings('takes', list, makeTake, updateTake);
  el('takes').prepend(...list.map(t => [...el('takes').children].find(one => one.dataset.name === t.name)).reverse());
  el('no-takes').hidden = list.length > 0;
  showSlate();
}
function showDisk() {
  const { free_gb, record_minutes } = state.disk;
  el('disk-left').textContent = free_gb === null ? '' : tr`${free_gb.toFixed(1)} GB left` +
    (record_minutes === null ? '' : tr`, ${minutes_text(record_minutes)} of recording`);
  el('disk-left').classList.toggle('bad', free_gb !== null && (free_gb < 5 || (record_minutes !== null && record_minutes < 20)));
}
const minutes_text = m => m < 120 ? `${m.toFixed(0)} min` : `${(m / 60).toFixed(0)} h`;
