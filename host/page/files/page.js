// SPDX-License-Identifier: Apache-2.0
// The operator's page: state comes by the event socket, changes go by REST (docs/page_openapi.yaml).
'use strict';

const state = {};
const el = id => document.getElementById(id);
let socket = null, adding_lamp = false, focusing = false, dragged = '';

function make(tag, fields, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(fields || {}))
    if (key.startsWith('on')) node.addEventListener(key.slice(2), value);
    else if (key in node && key !== 'list') node[key] = value;
    else node.setAttribute(key, value);
  node.append(...children);
  return node;
}
function set(node, key, value) { if (node[key] !== value) node[key] = value; }
// A control that is being used keeps what the user does.
function setValue(node, value) { if (document.activeElement !== node) set(node, 'value', String(value)); }

let message_timer = 0;
function tell(text) {
  el('message').textContent = text;
  el('message').hidden = !text;
  clearTimeout(message_timer);
  if (text) message_timer = setTimeout(() => tell(''), 8000);
}

async function ask(method, path, body, type) {
  try {
    const answer = await fetch('/api/v1/' + path, {
      method, body: type ? body : JSON.stringify(body || {}),
      headers: { 'Content-Type': type || 'application/json' } });
    if (answer.ok) return true;
    tell((await answer.json()).error || `refused: ${answer.status}`);
  } catch (error) {
    tell('the rig does not answer');
  }
  return false;
}
// While one change is under way only the newest of those that follow is kept.
const waiting = new Map();
async function askNewest(key, method, path, body) {
  if (waiting.has(key)) { waiting.set(key, [method, path, body]); return; }
  waiting.set(key, null);
  await ask(method, path, body);
  const next = waiting.get(key);
  waiting.delete(key);
  if (next) await askNewest(key, ...next);
}
const thing_path = (kind, name) => `${kind}/${encodeURIComponent(name)}`;

// ---- the socket
function connect() {
  socket = new WebSocket(`ws://${location.host}/api/v1/event/websocket`);
  const request = data => socket.readyState === 1 && socket.send(JSON.stringify({ type: 'request', data }));
  const askTime = () => { time_sent.push(performance.now()); request({ action: 'time' }); };
  const time_sent = [];
  let timer = 0;
  socket.onopen = () => {
    request({ action: 'subscribe', properties: ['*'] });
    Picture.tryWebrtc();
    askTime();
    timer = setInterval(askTime, 2000);
  };
  socket.onmessage = event => {
    const { data } = JSON.parse(event.data);
    if (data.action === 'time') Picture.noteClock(time_sent.shift(), data.host_ms);
    if (data.action === 'subscribe')
      for (const [key, value] of Object.entries(data.values || {})) take(key.slice(1), value);
    if (data.action === 'propertyValueChanged') take(data.property.slice(1), data.value);
  };
  socket.onclose = () => {
    clearInterval(timer);
    el('summary').textContent = 'no connection to the rig';
    el('summary').className = 'bad';
    setTimeout(connect, 1000);
  };
}
function take(part, value) {
  state[part] = value;
  if (show[part]) show[part](value);
}

// ---- what is shown
const show = {
  view(view) {
    for (const tab of document.querySelectorAll('[data-view]')) {
      const on = tab.dataset.view === view;
      tab.setAttribute('aria-selected', on);
      tab.tabIndex = on ? 0 : -1;
    }
    el('canvas').setAttribute('aria-label', `Live picture: ${view}`);
    Picture.show(view);
  },
  freeze(on) { el('freeze').setAttribute('aria-pressed', on); },
  picture(p) {
    el('summary').className = '';
    el('summary').textContent = `frame ${p.frame}, ${p.fps.toFixed(1)} frames a second, ` +
      `${p.frame_ms.toFixed(0)} ms each, delay ${p.delay_ms.toFixed(0)} ms`;
    showHealth();
  },
  recording(r) {
    const tally = el('tally');
    tally.dataset.on = r.on;
    tally.textContent = r.on ? `recording ${r.name}` : 'not recording';
    el('record').dataset.on = r.on;
    el('record').textContent = r.on ? 'Stop' : 'Record';
    el('record').disabled = !r.possible;
    el('record-state').textContent = r.on
      ? `${r.seconds.toFixed(1)} s, ${r.frames} frames, ${r.lost} lost`
      : r.error ? r.error : r.folder ? `written: ${r.folder}` : '';
    el('record-state').className = r.error ? 'bad' : '';
  },
  background(b) {
    el('background').textContent = b.text;
    el('learn').disabled = !b.possible;
  },
  scan(s) {
    el('scan').disabled = !s.possible;
    el('scan').textContent = s.total ? 'Cancel' : 'Learn the empty room';
    el('scan-progress').hidden = !s.total;
    el('scan-progress').value = s.total ? s.done / s.total : 0;
    el('scan-state').textContent = s.total ? `${s.done} of ${s.total} looks: leave the set empty` : s.why_not;
  },
  sweep(s) {
    const at_work = s.phase !== 'idle';
    el('sweep').disabled = at_work ? s.phase !== 'sweeping' : !s.possible;
    el('sweep').textContent = s.phase === 'sweeping' ? 'Cancel' : 'Scan the room with the head';
    for (const id of ['sweep-pan', 'sweep-tilt']) el(id).disabled = at_work || !s.possible;
    el('sweep-progress').hidden = s.phase !== 'sweeping';
    el('sweep-progress').value = s.total ? s.done / s.total : 0;
    el('sweep-state').className = s.error && !at_work ? 'hint bad' : 'hint';
    el('sweep-state').textContent =
      s.phase === 'sweeping' ? `${s.name}: ${s.done} of ${s.total} views` + (s.left_s ? `, ${s.left_s} s left` : '')
        : s.phase === 'modelling' ? `${s.name}: the room is made of its views`
          : s.error ? s.error
            : s.folder ? `written: ${s.folder}; it is the background of the next start` : s.why_not;
  },
  focus(f) {
    el('focus-on').setAttribute('aria-pressed', f.on);
    for (const [id, value] of [['focus-distance', f.distance_m], ['focus-number', f.on ? f.f_number : null]])
      setValue(el(id), value === null ? '' : Number(value.toPrecision(5)));
    el('focus-number').disabled = !f.on;
    el('focus-state').textContent = !f.on ? 'all is sharp'
      : f.at ? 'sharp where the ring is' : `sharp at ${f.distance_m.toFixed(2)} m`;
    showHandles();
  },
  objects(list) { showThings('objects', list, makeObject, updateObject); showHandles(); },
  cameras(list) {
    el('cameras-panel').hidden = list.length === 0;
    showThings('cameras', list, makeCamera, updateCamera);
  },
  lamps(list) { showThings('lamps', list, makeLamp, updateLamp); showHandles(); },
  disk: showHealth, calibration: showHealth, pose: showHealth, run: showHealth,
  streams(list) {
    el('streams').replaceChildren(...list.map(s => make('li', { className: s.ok ? '' : 'bad' },
      `${s.name}: ${s.ok ? 'delivers' : s.do}` + (s.frames ? `, ${s.frames} frames, ${s.lost} lost` : ''))));
  },
  log(lines) {
    const box = el('log'), at_end = box.scrollTop + box.clientHeight >= box.scrollHeight - 4;
    box.textContent = lines.length ? lines.join('\n') : 'nothing was logged';
    if (at_end) box.scrollTop = box.scrollHeight;
  },
};

function age_text(seconds) {
  if (seconds === null) return '';
  if (seconds < 7200) return `, made ${Math.round(seconds / 60)} min ago`;
  return seconds < 172800 ? `, made ${Math.round(seconds / 3600)} h ago`
    : `, made ${Math.round(seconds / 86400)} days ago`;
}
function showHealth() {
  const { run, pose, disk, calibration: c, picture } = state;
  if (!run || !pose || !disk || !c || !picture) return;
  const rows = [
    ['Scene', run.scene], ['Source', run.source + (run.live ? ' (live)' : ' (played)')],
    ['Pose', pose.state + (pose.objects_shown ? '' : ', objects are hidden'), pose.state !== 'ok'],
    ['Calibration', `${c.verdict}: ${c.reason} (${c.file || 'none'}${age_text(c.age_s)})`, c.verdict !== 'go'],
    ['Disk', disk.free_gb === null ? 'unknown' : `${disk.free_gb.toFixed(1)} GB free`,
      disk.free_gb !== null && disk.free_gb < 5],
    ['Picture', `${picture.width} x ${picture.height}`]];
  el('health').replaceChildren(...rows.flatMap(([name, text, bad]) =>
    [make('dt', {}, name), make('dd', { className: bad ? 'bad' : '' }, text)]));
}

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
function field(label, name, input) {
  input.setAttribute('aria-label', `${label} of ${name}`);
  input.dataset.field = label;
  return input;
}
const part = (block, name) => block.querySelector(`[data-field="${name}"]`);

function makeObject(o) {
  const put = body => askNewest('object ' + o.name, 'PUT', thing_path('objects', o.name), body);
  const turn = field('turn', o.name, make('input', { type: 'range', min: -180, max: 180, step: 1,
    oninput: e => put({ turn_deg: Number(e.target.value), preview: true }),
    onchange: e => put({ turn_deg: Number(e.target.value) }) }));
  const scale = field('scale', o.name, make('input', { type: 'number', min: 0.01, max: 100, step: 0.05,
    onchange: e => put({ scale: Number(e.target.value) }) }));
  const hide = field('hide', o.name, make('button', { 'aria-pressed': 'false',
    onclick: e => put({ hidden: e.currentTarget.getAttribute('aria-pressed') !== 'true' }) }, 'Hide'));
  const remove = field('remove', o.name, make('button', {
    onclick: () => confirm(`Remove ${o.name} from the scene?`) &&
      ask('DELETE', thing_path('objects', o.name)) }, 'Remove'));
  return make('div', { className: 'thing' }, make('b', {}, o.name), ' ',
    make('span', { className: 'hint' }),
    make('div', { className: 'row' }, make('span', { className: 'hint' }, 'turn'), turn),
    make('div', { className: 'row' }, make('span', { className: 'hint' }, 'scale'), scale, hide, remove));
}
function updateObject(block, o) {
  set(block.querySelector('.hint'), 'textContent', o.position_m.map(v => v.toFixed(2)).join(', ') + ' m');
  setValue(part(block, 'turn'), Math.round(o.turn_deg));
  setValue(part(block, 'scale'), o.scale);
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
  const put = body => askNewest('lamp ' + l.name, 'PUT', thing_path('lamps', l.name), body);
  const strength = field('strength', l.name, make('input', { type: 'range', min: -2, max: 2, step: 0.02 }));
  const color = field('color', l.name, make('input', { type: 'color' }));
  const on = field('on', l.name, make('button', { 'aria-pressed': 'true',
    onclick: e => put({ on: e.currentTarget.getAttribute('aria-pressed') !== 'true' }) }, 'On'));
  const remove = field('remove', l.name, make('button', {
    onclick: () => confirm(`Remove ${l.name} from the scene?`) &&
      ask('DELETE', thing_path('lamps', l.name)) }, 'Remove'));
  const block = make('div', { className: 'thing' }, make('b', {}, l.name), ' ',
    make('span', { className: 'hint' }),
    make('div', { className: 'row' }, make('span', { className: 'hint' }, 'strength'), strength, color),
    make('div', { className: 'row' }, on, remove));
  for (const input of [strength, color]) {
    input.addEventListener('input', () => put({ intensity: intensity_of(block), preview: true }));
    input.addEventListener('change', () => put({ intensity: intensity_of(block) }));
  }
  return block;
}
function updateLamp(block, l) {
  set(block.querySelector('.hint'), 'textContent',
    l.on ? `strength ${strength_of(l).toPrecision(3)}` : 'off');
  part(block, 'on').setAttribute('aria-pressed', l.on);
  if (!l.on) return;
  setValue(part(block, 'strength'), Math.log10(Math.max(0.01, strength_of(l))).toFixed(2));
  setValue(part(block, 'color'), color_text(l));
}

// ---- cameras: by the keys of rig.toml
const setting_names = { exposure_ms: 'exposure, ms', gain: 'gain', focus: 'focus',
  white_balance_k: 'white balance, K', zoom: 'zoom' };
function makeCamera(c) {
  const put = body => askNewest('camera ' + c.name, 'PUT', thing_path('cameras', c.name), body);
  const rows = c.settings.map(s => {
    const label = setting_names[s.name] || s.name;
    const range = { min: s.minimum, max: s.maximum, step: s.step || 'any' };
    const slider = field(label, c.name, make('input', { type: 'range', ...range,
      oninput: e => put({ [s.name]: Number(e.target.value), preview: true }),
      onchange: e => put({ [s.name]: Number(e.target.value) }) }));
    const number = field(`${label} as number`, c.name, make('input', { type: 'number', ...range, step: 'any',
      onchange: e => put({ [s.name]: Number(e.target.value) }) }));
    return make('div', { className: 'row' }, make('span', { className: 'hint' }, label), slider, number);
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

// ---- the picture: marks of objects and lamps
function place(handle, at) {
  handle.style.left = `${100 * at[0]}%`;
  handle.style.top = `${100 * at[1]}%`;
}
function showHandles() {
  const box = el('handles');
  const wanted = [];
  for (const o of state.objects || []) if (o.at && !o.hidden) wanted.push(['object', o]);
  for (const l of state.lamps || []) if (l.at) wanted.push(['lamp', l]);
  if (state.focus && state.focus.at) wanted.push(['focus', { name: 'sharp', at: state.focus.at }]);
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
  const put = body => askNewest('object ' + o.name, 'PUT', thing_path('objects', o.name), body);
  const handle = make('button', { className: 'handle', 'aria-label': `Move ${o.name}` },
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
  handle.addEventListener('pointercancel', () => { dragged = ''; });
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
el('stage').addEventListener('click', async e => {
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
  el('focus-pick').textContent = on ? 'Click on what is to be sharp' : 'Sharp by click';
}
function setAddingLamp(on) {
  if (on) setFocusing(false);
  adding_lamp = on;
  el('add-lamp').setAttribute('aria-pressed', on);
  el('add-lamp').textContent = on
    ? (el('lamp-where').value === 'above_floor_m' ? 'Click on the floor' : 'Click on the light') : 'Add by click';
}

// The age grows until a new picture comes: a picture that stands never looks live.
function showAge() {
  const age_ms = Picture.age_ms();
  el('age').dataset.ms = age_ms === null ? '' : age_ms.toFixed(0);
  el('age').textContent = age_ms === null ? 'no picture yet'
    : `frame ${Picture.frame}, ${age_ms < 10000 ? age_ms.toFixed(0) + ' ms' : (age_ms / 1000).toFixed(0) + ' s'} old, by ${Picture.by}`;
  el('age').title = Picture.by === 'MJPEG' && Picture.why_not ? `no WebRTC: ${Picture.why_not}` : '';
  el('age').dataset.by = Picture.by;
  const stale = age_ms !== null && age_ms > 1000;
  el('stale').hidden = !stale;
  if (stale)
    el('stale').textContent = `${state.freeze ? 'frozen' : 'no new picture'}: ${(age_ms / 1000).toFixed(1)} s old`;
}
setInterval(showAge, 100);

// ---- controls
for (const tab of document.querySelectorAll('[data-view]')) {
  tab.addEventListener('click', () => ask('PUT', 'view', { view: tab.dataset.view }));
  tab.addEventListener('keydown', e => {
    const next = e.key === 'ArrowRight' ? tab.nextElementSibling
      : e.key === 'ArrowLeft' ? tab.previousElementSibling : null;
    if (next) { next.focus(); next.click(); }
  });
}
el('freeze').addEventListener('click', () => ask('PUT', 'freeze', { on: !state.freeze }));
el('record').addEventListener('click', () => state.recording && state.recording.on
  ? ask('POST', 'record/stop')
  : ask('POST', 'record/start', { name: el('take-name').value.trim(), notes: el('take-notes').value }));
el('save').addEventListener('click', () => ask('POST', 'scene/save'));
el('scan').addEventListener('click', () =>
  ask('POST', state.scan && state.scan.total ? 'background/cancel' : 'background/scan'));
el('sweep').addEventListener('click', () => state.sweep && state.sweep.phase === 'sweeping'
  ? ask('POST', 'sweep/cancel')
  : ask('POST', 'sweep/start', { field_deg: [Number(el('sweep-pan').value), Number(el('sweep-tilt').value)] }));
el('focus-on').addEventListener('click', () => ask('PUT', 'focus', { on: !(state.focus && state.focus.on) }));
el('focus-pick').addEventListener('click', () => setFocusing(!focusing));
el('focus-distance').addEventListener('change', e =>
  e.target.value && ask('PUT', 'focus', { distance_m: Number(e.target.value) }));
el('focus-number').addEventListener('change', e =>
  e.target.value && ask('PUT', 'focus', { f_number: Number(e.target.value) }));
el('learn').addEventListener('click', () => ask('POST', 'background/learn'));
el('lamp-where').addEventListener('change', () => {
  el('lamp-height').disabled = !el('lamp-where').value;
  setAddingLamp(adding_lamp);
});
el('add-lamp').addEventListener('click', () => setAddingLamp(!adding_lamp));
el('upload').addEventListener('change', async e => {
  const file = e.target.files[0];
  if (!file) return;
  const name = file.name.replace(/\.glb$/i, '').slice(0, 60) || 'model';
  await ask('POST', thing_path('objects', name), file, 'model/gltf-binary');
  e.target.value = '';
});
connect();
