// SPDX-License-Identifier: Apache-2.0
// The connection to the rig: state comes by the event socket, and a rig that says nothing is shown as lost.
'use strict';

const Live = {
  socket: null, heard_ms: 0, lost: true, ever: false, timer: 0,
  silence_ms: 5000,   // the rig answers a question each 2 s

  connect() {
    const socket = this.socket = new WebSocket(`ws://${location.host}/api/v1/event/websocket`);
    const request = data => socket.readyState === 1 && socket.send(JSON.stringify({ type: 'request', data }));
    const time_sent = [];
    const askTime = () => { time_sent.push(performance.now()); request({ action: 'time' }); };
    let timer = 0;
    this.heard_ms = performance.now();
    socket.onopen = () => {
      request({ action: 'subscribe', properties: ['*'] });
      Picture.tryWebrtc();
      askTime();
      timer = setInterval(askTime, 2000);
    };
    socket.onmessage = event => {
      if (socket !== this.socket) return;
      this.heard_ms = performance.now();
      const { data } = JSON.parse(event.data);
      if (data.action === 'time') Picture.noteClock(time_sent.shift(), data.host_ms);
      if (data.action === 'subscribe') {
        for (const [key, value] of Object.entries(data.values || {})) take(key.slice(1), value);
        this.set(false);
      }
      if (data.action === 'propertyValueChanged') take(data.property.slice(1), data.value);
    };
    socket.onclose = () => {
      clearInterval(timer);
      if (socket !== this.socket) return;
      this.set(true);
      setTimeout(() => { if (socket === this.socket) this.connect(); }, 1000);
    };
  },
  // A rig that hangs, or a cable that was pulled, closes nothing.
  look() {
    const silent_ms = performance.now() - this.heard_ms;
    if (silent_ms > this.silence_ms) {
      this.set(true);
      this.socket.close();
      this.connect();
    }
    showAlarms();
  },
  set(lost) {
    if (lost && !this.lost) this.since_ms = this.heard_ms;
    this.lost = lost;
    if (!lost) this.ever = true;
    else if (this.ever) el('summary').textContent = tr`no connection to the rig; trying again`;
    document.body.dataset.link = lost ? (this.ever ? 'lost' : 'first') : 'up';
    el('record').disabled = lost || !(state.recording && state.recording.possible);
    showTally();
    showAlarms();
  },
};
function take(part, value) {
  state[part] = value;
  if (show[part]) show[part](value);
}

// What is being recorded; by colour, by a sign and in words. Of a lost rig nobody knows.
function showTally() {
  const r = state.recording || {}, tally = el('tally');
  const text = Live.lost ? (r.on ? tr`not known: was recording ${r.name}` : Live.ever ? tr`not known` : tr`connecting`)
    : r.on ? tr`recording ${r.name}` : tr`not recording`;
  set(tally, 'textContent', text);
  tally.dataset.on = Live.lost ? 'unknown' : Boolean(r.on);
  el('tally-time').textContent = r.on && !Live.lost ? clock_text(r.seconds) : '';
  document.title = Live.lost ? tr`NO CONNECTION, mixrig` : r.on ? tr`REC ${r.name}, mixrig` : 'mixrig';
}
const clock_text = s => `${Math.floor(s / 60)}:${String(Math.floor(s % 60)).padStart(2, '0')}`;

let seen_error = '';
function alarms() {
  const since = ms => `${Math.max(0, (performance.now() - ms) / 1000).toFixed(0)} s`;
  if (Live.lost) {
    if (!Live.ever) return [];
    const r = state.recording;
    return [tr`No connection to the rig for ${since(Live.since_ms)}: all that is shown is old. Trying again.` +
      (r && r.on ? ' ' + tr`It was recording ${r.name}: look at the rig whether it still does.` : '')];
  }
  const { picture, recording, pose, streams } = state, all = [];
  if (recording && recording.error && recording.error !== seen_error)
    all.push(tr`Recording ${recording.name} ended: ${recording.error}`);
  if (picture && picture.frames > 0 && picture.since_frame_s > 2)
    all.push(tr`The run stands: no frame for ${picture.since_frame_s.toFixed(0)} s.`);
  if (pose && pose.state !== 'ok' && pose.state !== 'unknown') all.push(tr`Pose lost: ${pose.state}.`);
  for (const s of streams || []) if (!s.ok) all.push(`${s.name} ${s.do}`);
  return all;
}
function showAlarms() {
  const all = alarms(), text = all.join('\n');
  const said = Live.lost && Live.ever ? 'lost' : text;   // the seconds are not read aloud again and again
  set(el('alarms'), 'hidden', !all.length);
  set(el('alarms-text'), 'textContent', text);
  if (el('alarms').dataset.said !== said) {
    el('alarms').dataset.said = said;
    el('said').textContent = text;
  }
  el('alarms-seen').hidden = Live.lost || !(state.recording && state.recording.error && state.recording.error !== seen_error);
  el('lost').hidden = !(Live.lost && Live.ever);
}
el('alarms-seen').addEventListener('click', () => { seen_error = state.recording.error; showAlarms(); });
setInterval(() => Live.look(), 500);
