// SPDX-License-Identifier: Apache-2.0
// Objects, lamps and cameras: a block of controls each.
'use strict';

// One block a thing, kept while it is there, so that focus stays.
function showThings(kind, list, build, update) {
  const box = el(kind), names = list.map(thing => thing.name);
  for (const block of [...box.children]) if (!names.includes(block.dataset.name)) block.remove();
  for (const thing of list) {
    let block = [...box.children].find(one => one.dataset.name === thing.name);
    if (!block) {
      block = build(thing);
      block.dataset.name = thing.name;
      box.append(block);
    }
    update(block, thing);
  }
}
// A name that no object has.
function freeName(name) {
  const names = (state.objects || []).map(one => one.name);
  let free = name;
  for (let i = 2; names.includes(free); ++i) free = `${name} ${i}`;
  return free;
}
function field(label, name, input) {
  input.setAttribute('aria-label', tr`${tr(label)} of ${name}`);
  input.dataset.field = label;
  return input;
}
const part = (block, name) => block.querySelector(`[data-field="${name}"]`);

async function removeThing(kind, name) {
  if (await ask('DELETE', thing_path(kind, name))) note(tr`Removed ${name}.`, true);
}

function makeObject(o) {
  const put = body => change('object ' + o.name, thing_path('objects', o.name), body);
  const turn = field('turn', o.name, make('input', { type: 'range', min: -180, max: 180, step: 1,
    oninput: e => put({ turn_deg: Number(e.target.value), preview: true }),
    onchange: e => put({ turn_deg: Number(e.target.value) }) }));
  const scale = field('scale', o.name, make('input', { type: 'number', min: 0.01, max: 100, step: 0.05,
    onchange: e => put({ scale: Number(e.target.value) }) }));
  const hide = field('hide', o.name, make('button', { 'aria-pressed': 'false',
    onclick: e => put({ hidden: e.currentTarget.getAttribute('aria-pressed') !== 'true' }) }, tr`Hide`));
  const remove = field('remove', o.name, make('button', {
    onclick: () => removeThing('objects', o.name) }, tr`Remove`));
  const rename = field('name', o.name, make('input', { type: 'text', maxLength: 64, value: o.name,
    onchange: e => e.target.value && e.target.value !== o.name && put({ name: e.target.value }) }));
  const copy = field('duplicate', o.name, make('button', {
    onclick: () => ask('POST', thing_path('objects', o.name) + '/copy') }, tr`Duplicate`));
  return make('div', { className: 'thing' }, rename,
    make('span', { className: 'hint where' }),
    make('div', { className: 'row' }, make('span', { className: 'hint' }, tr`turn`), turn),
    make('div', { className: 'row' }, make('span', { className: 'hint' }, tr`scale`), scale, hide, copy, remove));
}
function updateObject(block, o) {
  set(block.querySelector('.where'), 'textContent', o.position_m.map(v => v.toFixed(2)).join(', ') + ' m');
  setValue(part(block, 'turn'), Math.round(o.turn_deg));
  setValue(part(block, 'scale'), o.scale);
  setValue(part(block, 'name'), o.name);
  part(block, 'hide').setAttribute('aria-pressed', o.hidden);
  for (const name of ['turn']) part(block, name).disabled = o.moves;
}

// A lamp has a colour (its brightest channel is 1) and a strength.
const strength_of = lamp => Math.max(...lamp.intensity);
const to_byte = v => Math.round(255 * Math.pow(Math.min(1, Math.max(0, v)), 1 / 2.2));
const from_byte = b => Math.pow(b / 255, 2.2);
function color_text(lamp) {
  const most = strength_of(lamp) || 1;
  return '#' + lamp.intensity.map(v => to_byte(v / most).toString(16).padStart(2, '0')).join('');
}
function intensity_of(block) {
  const strength = Math.pow(10, Number(part(block, 'strength').value));
  const color = part(block, 'color').value;
  const rgb = [1, 3, 5].map(i => from_byte(parseInt(color.slice(i, i + 2), 16)));
  const most = Math.max(...rgb) || 1;
  return rgb.map(v => strength * v / most);
}
function makeLamp(l) {
  const put = body => change('lamp ' + l.name, thing_path('lamps', l.name), body);
  const strength = field('strength', l.name, make('input', { type: 'range', min: -2, max: 2, step: 0.02 }));
  const color = field('color', l.name, make('input', { type: 'color' }));
  const on = field('on', l.name, make('button', { 'aria-pressed': 'true',
    onclick: e => put({ on: e.currentTarget.getAttribute('aria-pressed') !== 'true' }) }, tr`On`));
  const remove = field('remove', l.name, make('button', {
    onclick: () => removeThing('lamps', l.name) }, tr`Remove`));
  const block = make('div', { className: 'thing' }, make('b', {}, l.name), ' ',
    make('span', { className: 'hint' }),
    make('div', { className: 'row' }, make('span', { className: 'hint' }, tr`strength`), strength, color),
    make('div', { className: 'row' }, on, remove));
  for (const input of [strength, color]) {
    input.addEventListener('input', () => put({ intensity: intensity_of(block), preview: true }));
    input.addEventListener('change', () => put({ intensity: intensity_of(block) }));
  }
  return block;
}
function updateLamp(block, l) {
  set(block.querySelector('.hint'), 'textContent',
    l.on ? tr`strength ${strength_of(l).toPrecision(3)}` : tr`off`);
  part(block, 'on').setAttribute('aria-pressed', l.on);
  if (!l.on) return;
  setValue(part(block, 'strength'), Math.log10(Math.max(0.01, strength_of(l))).toFixed(2));
  setValue(part(block, 'color'), color_text(l));
}

// ---- cameras: by the keys of rig.toml
const setting_names = { exposure_ms: 'exposure, ms', gain: 'gain', focus: 'focus',
  white_balance_k: 'white balance, K', zoom: 'zoom' };
function makeCamera(c) {
  const put = body => change('camera ' + c.name, thing_path('cameras', c.name), body);
  const rows = c.settings.map(s => {
    const label = setting_names[s.name] || s.name;
    const range = { min: s.minimum, max: s.maximum, step: s.step || 'any' };
    const slider = field(label, c.name, make('input', { type: 'range', ...range,
      oninput: e => put({ [s.name]: Number(e.target.value), preview: true }),
      onchange: e => put({ [s.name]: Number(e.target.value) }) }));
    const number = field(`${label} as number`, c.name, make('input', { type: 'number', ...range, step: 'any',
      onchange: e => put({ [s.name]: Number(e.target.value) }) }));
    number.setAttribute('aria-label', tr`${tr(label)} as number of ${c.name}`);
    return make('div', { className: 'row' }, make('span', { className: 'hint' }, tr(label)), slider, number);
  });
  return make('div', { className: 'thing' }, make('b', {}, c.name), ...rows);
}
function updateCamera(block, c) {
  for (const s of c.settings) {
    const label = setting_names[s.name] || s.name;
    if (s.value === null) continue;
    setValue(part(block, label), s.value);
    setValue(part(block, `${label} as number`), Number(s.value.toPrecision(6)));
  }
}
