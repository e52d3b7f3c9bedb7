// SPDX-License-Identifier: Apache-2.0
// The live picture, drawn into a canvas, with its age: a stream of JPEGs until pictures come by
// WebRTC, and where they do not.
'use strict';

const Picture = {
  view: '', abort: null, webrtc: null, by: 'MJPEG', why_not: '', captured_ms: 0, frame: 0, offset_ms: null, offset_error_ms: 0,
  again_ms: 5000,   // until WebRTC is tried again; twice as long each time that no picture came by it

  // Host time = performance.now() + offset. The answer that came back soonest tells it best.
  noteClock(sent_ms, host_ms) {
    const now_ms = performance.now(), error_ms = (now_ms - sent_ms) / 2;
    if (this.offset_ms !== null && error_ms > this.offset_error_ms + 0.5) {
      this.offset_error_ms += 0.05;  // clocks drift: an old one is trusted less and less
      return;
    }
    this.offset_ms = host_ms - (sent_ms + now_ms) / 2;
    this.offset_error_ms = error_ms;
  },
  age_ms() {
    if (this.offset_ms === null || this.captured_ms === 0) return null;
    return performance.now() + this.offset_ms - this.captured_ms;
  },

  show(view) {
    if (view === this.view) return;
    this.view = view;
    if (this.webrtc) this.webrtc.show(view);
    if (this.by === 'MJPEG') this.startJpegs();
  },
  // At each connection of the page, and again some time after it ended: a loaded machine may hold pictures up.
  tryWebrtc() {
    if (this.webrtc || new URLSearchParams(location.search).get('picture') === 'mjpeg') return;
    this.webrtc = new Webrtc(this.view || 'composite', (video, captured_ms, frame) => {
      if (this.by === 'MJPEG' && this.abort) this.abort.abort();
      this.by = 'WebRTC';
      this.again_ms = 5000;
      this.drawn(video, video.videoWidth, video.videoHeight, captured_ms, frame);
    }, (why, may_come) => {
      const was = this.by;
      this.webrtc = null;
      this.by = 'MJPEG';
      this.why_not = why;
      if (was === 'WebRTC' && this.view) this.startJpegs();
      if (may_come) setTimeout(() => this.tryWebrtc(), this.again_ms);
      this.again_ms = Math.min(2 * this.again_ms, 300000);
    });
    if (this.webrtc.is_over) this.webrtc = null;
  },

  startJpegs() {
    if (this.abort) this.abort.abort();
    this.run(this.view);
  },

  async run(view) {
    const abort = this.abort = new AbortController();
    while (!abort.signal.aborted) {
      try {
        await this.read(view, abort.signal);
      } catch (error) {
        if (!abort.signal.aborted) await new Promise(done => setTimeout(done, 500));
      }
    }
  },

  async read(view, signal) {
    const answer = await fetch(`/api/v1/picture/${view}.mjpeg`, { signal });
    if (!answer.ok) throw new Error(`picture: ${answer.status}`);
    const reader = answer.body.getReader();
    let held = new Uint8Array(0);
    for (;;) {
      const { value, done } = await reader.read();
      if (done) return;
      const more = new Uint8Array(held.length + value.length);
      more.set(held);
      more.set(value, held.length);
      held = more;
      let newest = null;
      for (let part = nextPart(held); part; part = nextPart(held)) {
        held = held.subarray(part.end);
        newest = part;
      }
      if (newest) await this.draw(newest);
    }
  },

  async draw(part) {
    const bitmap = await createImageBitmap(new Blob([part.bytes], { type: 'image/jpeg' }));
    if (this.by === 'MJPEG')
      this.drawn(bitmap, bitmap.width, bitmap.height, Number(part.fields['x-captured-ms']),
        Number(part.fields['x-frame']));
    bitmap.close();
  },

  drawn(image, width, height, captured_ms, frame) {
    const canvas = document.getElementById('canvas');
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    canvas.getContext('2d').drawImage(image, 0, 0, width, height);
    this.captured_ms = captured_ms;
    this.frame = frame;
    canvas.dataset.frame = frame;
  },
};

// {fields, bytes, end} of the first whole part in `held`, or null.
function nextPart(held) {
  const limit = Math.min(held.length, 1024);
  let head_end = -1;
  for (let i = 0; i + 3 < limit; ++i)
    if (held[i] === 13 && held[i + 1] === 10 && held[i + 2] === 13 && held[i + 3] === 10) {
      head_end = i + 4;
      break;
    }
  if (head_end < 0) return null;
  const fields = {};
  for (const line of new TextDecoder().decode(held.subarray(0, head_end)).split('\r\n')) {
    const colon = line.indexOf(':');
    if (colon > 0) fields[line.slice(0, colon).toLowerCase()] = line.slice(colon + 1).trim();
  }
  const length = Number(fields['content-length']);
  if (!(length >= 0) || held.length < head_end + length + 2) return null;
  return { fields, bytes: held.subarray(head_end, head_end + length), end: head_end + length + 2 };
}
