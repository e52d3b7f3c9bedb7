// SPDX-License-Identifier: Apache-2.0
// Pictures by WebRTC (docs/reference/page_api.md): the rig offers, the browser answers, and the rig tells which
// frame each picture is.
'use strict';

class Webrtc {
  // `shown(video, captured_ms, frame)` for each picture; `ended(why, may_come)` once, when there are no
  // more; may_come: whether a new try may do better.
  constructor(view, shown, ended) {
    this.shown = shown;
    this.ended = ended;
    this.video = document.getElementById('video');
    this.told = new Map();   // pictures by their RTP time stamps, the last ones
    this.captured_ms = 0;
    this.nameless = 0;       // pictures in a row without a time stamp
    this.told_since = null;   // first picture that was told after the last one that came
    if (!window.RTCPeerConnection || !this.video.requestVideoFrameCallback) {
      this.end(tr`this browser has no WebRTC`, false);
      return;
    }
    this.socket = new WebSocket(`ws://${location.host}/api/v1/picture/${view}.webrtc`);
    this.socket.onmessage = event => this.take(JSON.parse(event.data).data);
    this.socket.onclose = () => this.end(tr`the rig closed the connection`, true);
    this.watch = setInterval(() => this.checkThatItComes(), 500);
  }

  request(data) { this.socket.send(JSON.stringify({ type: 'request', data })); }
  show(view) { if (this.socket.readyState === 1) this.request({ action: 'view', view }); }

  async take(data) {
    if (data.action === 'refused') this.end(data.error, true);
    if (data.action === 'offer') {
      try {
        await this.answer(data.sdp);
      } catch (error) {
        this.end(tr`this browser refused the connection: ${error.message}`, false);
      }
    }
    if (data.action === 'picture') {
      if (this.told.size >= 64) this.told.delete(this.told.keys().next().value);
      this.told.set(data.rtp, data);
      if (this.told_since === null) this.told_since = performance.now();
    }
  }

  async answer(sdp) {
    this.peer = new RTCPeerConnection();
    this.peer.ontrack = event => {
      event.receiver.jitterBufferTarget = 0;  // the newest picture, not an even motion
      this.video.srcObject = new MediaStream([event.track]);
      this.video.play().catch(() => {});
      this.next();
    };
    await this.peer.setRemoteDescription({ type: 'offer', sdp });
    await this.peer.setLocalDescription(await this.peer.createAnswer());
    this.request({ action: 'answer', sdp: this.peer.localDescription.sdp });
  }

  next() {
    this.video.requestVideoFrameCallback((now, picture) => {
      if (this.is_over) return;
      this.nameless = picture.rtpTimestamp === undefined ? this.nameless + 1 : 0;  // so is one as a track ends
      if (this.nameless > 30) {
        this.end(tr`this browser does not say which frame it shows`, false);
        return;
      }
      if (this.nameless === 0) this.told_since = null;
      const told = this.told.get(picture.rtpTimestamp);
      if (told) {
        this.captured_ms = told.captured_ms;
        this.shown(this.video, told.captured_ms, told.frame);
      }
      this.next();
    });
  }

  // The rig says that it sends, and nothing comes: a network that lets no UDP through.
  checkThatItComes() {
    if (document.hidden) this.told_since = null;
    const most_ms = this.captured_ms ? 2000 : 10000;
    if (this.told_since !== null && performance.now() - this.told_since > most_ms)
      this.end(tr`no picture arrives`, true);
  }

  end(why, may_come) {
    if (this.is_over) return;
    this.is_over = true;
    clearInterval(this.watch);
    if (this.socket) this.socket.close();
    if (this.peer) this.peer.close();
    this.video.srcObject = null;
    this.ended(why, may_come);
  }
}
