// SPDX-License-Identifier: Apache-2.0
// Plays a finished take of the list: the rig decodes one picture after the other, and pictures are left out where
// that is slower than the take.
'use strict';

const Player = {
  name: '', frames: 0, rate_hz: 25, at: 1, began_ms: 0, began_at: 1, playing: false, url: '', busy: false,

  open(t) {
    Object.assign(this, { name: t.name, frames: t.frames, rate_hz: t.seconds > 0 ? t.frames / t.seconds : 25 });
    el('h-player').textContent = t.name;
    el('player-at').max = t.frames;
    el('player').showModal();
    this.seek(1);
    this.play(true);
  },
  seek(frame) {
    this.at = Math.max(1, Math.min(this.frames, Math.round(frame)));
    this.began_at = this.at;
    this.began_ms = performance.now();
    this.fetch();
  },
  play(on) {
    if (on && this.at >= this.frames) this.at = 1;
    this.playing = on;
    set(el('player-play'), 'textContent', on ? tr`Pause` : tr`Play`);
    this.seek(this.at);
  },
  async fetch() {
    if (this.busy) return;
    this.busy = true;
    const wanted = this.at, name = this.name;
    try {
      const answer = await fetch(`/api/v1/${thing_path('takes', name)}/${wanted}.jpg`);
      if (!answer.ok) throw new Error((await answer.json()).error || answer.status);
      URL.revokeObjectURL(this.url);
      this.url = el('player-picture').src = URL.createObjectURL(await answer.blob());
      el('player-picture').dataset.frame = wanted;
      setValue(el('player-at'), wanted);
      el('player-state').textContent = tr`${clock_text((wanted - 1) / this.rate_hz)} of ${clock_text(this.frames / this.rate_hz)}, frame ${wanted} of ${this.frames}`;
    } catch (error) {
      this.playing = false;
      el('player-state').textContent = tr`This take cannot be played: ${error.message}`;
    }
    this.busy = false;
    if (!el('player').open) return;
    if (this.playing) this.next();
    else if (this.at !== wanted) this.fetch();
  },
  next() {
    const due = this.began_at + Math.floor((performance.now() - this.began_ms) / 1000 * this.rate_hz);
    const wait_ms = due > this.at ? 0 : 1000 / this.rate_hz / 2;
    if (due > this.frames && this.at === this.frames) return this.end();
    setTimeout(() => {
      if (!this.playing || !el('player').open) return;
      if (due <= this.at) return this.next();
      this.at = Math.min(due, this.frames);
      this.fetch();
    }, wait_ms);
  },
  end() { this.playing = false; set(el('player-play'), 'textContent', tr`Play`); },
};
el('player-play').addEventListener('click', () => Player.play(!Player.playing));
el('player-at').addEventListener('input', e => { Player.end(); Player.seek(Number(e.target.value)); });
el('player-close').addEventListener('click', () => el('player').close());
el('player').addEventListener('close', () => Player.end());
