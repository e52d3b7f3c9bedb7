// SPDX-License-Identifier: Apache-2.0
// What the page shows of each part of the state, and its controls, which send changes by REST
// (docs/reference/page_openapi.yaml).
'use strict';

// ---- what is shown
const show = {
  view() { Views.show(); },
  freeze(on) { el('freeze').setAttribute('aria-pressed', on); },
  picture(p) {
    el('summary').textContent = tr`frame ${p.frame}, ${p.fps.toFixed(1)} frames per second, ${
      p.frame_ms.toFixed(0)} ms per frame, delay ${p.delay_ms.toFixed(0)} ms`;
    showHealth();
  },
  recording(r) {
    showTally();
    el('record').dataset.on = r.on;
    el('record').textContent = r.on ? tr`Stop` : tr`Record`;
    el('record').disabled = Live.lost || !r.possible;
    el('record-state').textContent = r.on
      ? tr`${r.seconds.toFixed(1)} s, ${r.frames} frames, ${r.lost} lost`
      : r.error ? r.error : r.folder ? tr`saved in ${r.folder}` : '';
    el('record-state').className = r.error ? 'bad' : '';
  },
  edits(e) { Edits.show(e); },
  background(b) {
    el('background').textContent = b.text;
    el('learn').disabled = !b.possible;
  },
  scan(s) {
    el('scan').disabled = !s.possible;
    el('scan').textContent = s.total ? tr`Cancel` : tr`Learn the empty room`;
    el('scan-progress').hidden = !s.total;
    el('scan-progress').value = s.total ? s.done / s.total : 0;
    el('scan-state').textContent = s.total ? tr`${s.done} of ${s.total} pictures taken: keep people off the set` : s.why_not;
  },
  sweep(s) {
    const at_work = s.phase !== 'idle';
    el('sweep').disabled = at_work ? s.phase !== 'sweeping' : !s.possible;
    el('sweep').textContent = s.phase === 'sweeping' ? tr`Cancel` : tr`Scan the room with the pan-tilt head`;
    for (const id of ['sweep-pan', 'sweep-tilt']) el(id).disabled = at_work || !s.possible;
    el('sweep-progress').hidden = s.phase !== 'sweeping';
    el('sweep-progress').value = s.total ? s.done / s.total : 0;
    el('sweep-state').className = s.error && !at_work ? 'hint bad' : 'hint';
    el('sweep-state').textContent =
      s.phase === 'sweeping' ? tr`${s.name}: ${s.done} of ${s.total} views` + (s.left_s ? tr`, ${s.left_s} s left` : '')
        : s.phase === 'modelling' ? tr`${s.name}: building the room from its views`
          : s.error ? s.error
            : s.folder ? tr`saved in ${s.folder}; it is the background from the next start on` : s.why_not;
  },
  focus(f) {
    el('focus-on').setAttribute('aria-pressed', f.on);
    for (const [id, value] of [['focus-distance', f.distance_m], ['focus-number', f.on ? f.f_number : null]])
      setValue(el(id), value === null ? '' : Number(value.toPrecision(5)));
    el('focus-number').disabled = !f.on;
    el('focus-state').textContent = !f.on ? tr`off: everything is sharp`
      : f.at ? tr`focused at the ring in the picture` : tr`focused at ${f.distance_m.toFixed(2)} m`;
    showHandles();
  },
  objects(list) { showThings('objects', list, makeObject, updateObject); showHandles(); },
  cameras(list) {
    el('cameras-panel').hidden = list.length === 0;
    showThings('cameras', list, makeCamera, updateCamera);
  },
  lamps(list) { showThings('lamps', list, makeLamp, updateLamp); showHandles(); },
  disk() { showHealth(); showDisk(); },
  takes(list) { showTakes(list); },
  presets(list) { showPresets(list); },
  calibration: showHealth, pose: showHealth, run: showHealth,
  streams(list) {
    el('streams').replaceChildren(...list.map(s => make('li', { className: s.ok ? '' : 'bad' },
      `${s.name}: ${s.ok ? tr`ok` : s.do}` + (s.frames ? tr`, ${s.frames} frames, ${s.lost} lost` : ''))));
  },
  log(lines) {
    const box = el('log'), at_end = box.scrollTop + box.clientHeight >= box.scrollHeight - 4;
    box.textContent = lines.length ? lines.join('\n') : tr`no messages`;
    if (at_end) box.scrollTop = box.scrollHeight;
  },
};

function age_text(seconds) {
  if (seconds === null) return '';
  if (seconds < 7200) return tr`, made ${Math.round(seconds / 60)} min ago`;
  return seconds < 172800 ? tr`, made ${Math.round(seconds / 3600)} h ago`
    : tr`, made ${Math.round(seconds / 86400)} days ago`;
}
function showHealth() {
  const { run, pose, disk, calibration: c, picture } = state;
  if (!run || !pose || !disk || !c || !picture) return;
  const rows = [
    [tr`Scene`, run.scene], [tr`Source`, `${run.source} (${run.live ? tr`live` : tr`recording`})`],
    [tr`Pose`, tr(pose.state) + (pose.objects_shown ? '' : tr`, virtual objects are hidden`), pose.state !== 'ok'],
    [tr`Calibration`, `${c.verdict}: ${c.reason} (${c.file || tr`none`}${age_text(c.age_s)})`, c.verdict !== 'go'],
    [tr`Disk`, disk.free_gb === null ? tr`unknown` : tr`${disk.free_gb.toFixed(1)} GB free`,
      disk.free_gb !== null && disk.free_gb < 5],
    [tr`Picture`, `${picture.width} x ${picture.height}`]];
  el('health').replaceChildren(...rows.flatMap(([name, text, bad]) =>
    [make('dt', {}, name), make('dd', { className: bad ? 'bad' : '' }, text)]));
}

// The age grows until a new picture comes: a picture that stands never looks live.
function showAge() {
  const age_ms = Picture.age_ms();
  el('age').dataset.ms = age_ms === null ? '' : age_ms.toFixed(0);
  const unknown = Picture.frame > 0 ? tr`frame ${Picture.frame}, its age is not known yet` : tr`no picture yet`;
  el('age').textContent = age_ms === null ? unknown
    : tr`frame ${Picture.frame}, ${age_ms < 10000 ? age_ms.toFixed(0) + ' ms' : (age_ms / 1000).toFixed(0) + ' s'} old, by ${Picture.by}`;
  el('age').title = Picture.by === 'MJPEG' && Picture.why_not ? tr`no WebRTC: ${Picture.why_not}` : '';
  el('age').dataset.by = Picture.by;
  const stale = age_ms !== null && age_ms > 1000;
  el('stale').hidden = !stale;
  if (stale)
    el('stale').textContent = tr`${state.freeze ? tr`frozen` : tr`no new picture`}, ${(age_ms / 1000).toFixed(1)} s old`;
}
setInterval(showAge, 100);

// ---- controls
el('freeze').addEventListener('click', () => ask('PUT', 'freeze', { on: !state.freeze }));
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
  if (await ask('POST', thing_path('objects', freeName(name)), file, 'model/gltf-binary')) note(tr`Added ${name}.`, true);
  e.target.value = '';
});
Live.connect();
