// SPDX-License-Identifier: Apache-2.0
// Marks of objects, lamps and the focus in the picture, and clicks in it.
'use strict';

let adding_lamp = false, focusing = false, dragged = '';

function place(handle, at) {
  handle.style.left = `${100 * at[0]}%`;
  handle.style.top = `${100 * at[1]}%`;
}
function showHandles() {
  const box = el('handles');
  const wanted = [];
  for (const o of state.objects || []) if (o.at && !o.hidden) wanted.push(['object', o]);
  for (const l of state.lamps || []) if (l.at) wanted.push(['lamp', l]);
  if (state.focus && state.focus.at) wanted.push(['focus', { name: 'focus', at: state.focus.at }]);
  const key = (kind, thing) => `${kind} ${thing.name}`;
  const keys = wanted.map(([kind, thing]) => key(kind, thing));
  for (const handle of [...box.children]) if (!keys.includes(handle.dataset.key)) handle.remove();
  for (const [kind, thing] of wanted) {
    let handle = [...box.children].find(one => one.dataset.key === key(kind, thing));
    if (!handle) {
      handle = kind === 'object' ? makeHandle(thing)
        : make('div', { className: `handle ${kind}` }, make('span', {}, thing.name));
      handle.dataset.key = key(kind, thing);
      box.append(handle);
    }
    if (thing.name !== dragged) place(handle, thing.at);
  }
}
function at_of(event) {
  const box = el('stage').getBoundingClientRect();
  const clamp = v => Math.min(1, Math.max(0, v));
  return [clamp((event.clientX - box.left) / box.width), clamp((event.clientY - box.top) / box.height)];
}
function makeHandle(o) {
  const put = body => change('object ' + o.name, thing_path('objects', o.name), body);
  const handle = make('button', { className: 'handle', 'aria-label': tr`Move ${o.name}` },
    make('span', {}, o.name));
  const to = () => el('onto').checked ? 'onto' : 'at';
  // The mark is taken where it is grabbed, and does not jump to the pointer.
  let grip = [0, 0];
  const moved = e => { const at = at_of(e); return [at[0] - grip[0], at[1] - grip[1]].map(v => Math.min(1, Math.max(0, v))); };
  handle.addEventListener('pointerdown', e => {
    const now = (state.objects || []).find(one => one.name === o.name);
    if (!now || !now.at || now.moves) return;
    const at = at_of(e);
    grip = [at[0] - now.at[0], at[1] - now.at[1]];
    handle.setPointerCapture(e.pointerId);
    dragged = o.name;
  });
  handle.addEventListener('pointermove', e => {
    if (dragged !== o.name) return;
    place(handle, moved(e));
    put({ [to()]: moved(e), preview: true });
  });
  handle.addEventListener('pointerup', e => {
    if (dragged !== o.name) return;
    dragged = '';
    put({ [to()]: moved(e) });
  });
  handle.addEventListener('pointercancel', () => { if (dragged === o.name) cancelDrag(); });
  handle.addEventListener('keydown', e => {
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const step = steps[e.key];
    const now = (state.objects || []).find(one => one.name === o.name);
    if (!step || !now || !now.at) return;
    e.preventDefault();
    const size = e.shiftKey ? 0.05 : 0.01;
    put({ [to()]: [0, 1].map(i => Math.min(1, Math.max(0, now.at[i] + size * step[i]))) });
  });
  return handle;
}
function cancelDrag() {
  dragged = '';
  Edits.cancel();
  showHandles();
}
el('stage').addEventListener('click', async e => {
  if (Edits.locked) return;
  if (focusing && !e.target.closest('button.handle')) {
    setFocusing(false);
    await ask('PUT', 'focus', { at: at_of(e) });
    return;
  }
  if (!adding_lamp || e.target.closest('.handle')) return;
  setAddingLamp(false);
  const where = el('lamp-where').value;
  const body = { at: at_of(e) };
  if (where) body[where] = Number(el('lamp-height').value);
  await ask('POST', 'lamps', body);
});
function setFocusing(on) {
  focusing = on;
  if (on) setAddingLamp(false);
  el('focus-pick').setAttribute('aria-pressed', on);
  el('focus-pick').textContent = on ? tr`Click in the picture on what to focus` : tr`Click to focus`;
}
function setAddingLamp(on) {
  if (on) setFocusing(false);
  adding_lamp = on;
  el('add-lamp').setAttribute('aria-pressed', on);
  el('add-lamp').textContent = on
    ? (el('lamp-where').value === 'above_floor_m' ? tr`Click on the floor below the lamp` : tr`Click on the lamp`) : tr`Add a lamp`;
}
