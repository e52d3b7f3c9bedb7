// SPDX-License-Identifier: Apache-2.0
// Undo and redo, the lock, and Escape, which takes back what is being dragged.
'use strict';

const Edits = {
  locked: false,
  cancelled: false,   // Escape ended this drag: what comes of it until the next one counts no more
  held: false,        // a pointer is down

  show(edits) {
    for (const [id, word] of [['undo', tr`Undo`], ['redo', tr`Redo`]]) {
      const what = edits[id];
      el(id).disabled = !what || this.locked;
      el(id).title = what ? `${word}: ${what}` : tr`${word}: nothing`;
      el(id).setAttribute('aria-label', el(id).title);
    }
  },
  async back(which) {
    if (this.locked) return note(tr`This page is locked: press L or Unlock.`);
    const what = state.edits && state.edits[which];
    if (!what) return note(which === 'undo' ? tr`There is nothing to undo.` : tr`There is nothing to redo.`);
    showAgain();
    if (await ask('POST', `scene/${which}`)) note(which === 'undo' ? tr`Undone: ${what}` : tr`Done again: ${what}`);
  },
  cancel() {
    this.cancelled = true;
    showAgain();
    const discard = ['POST', 'scene/discard', {}];   // after what is under way
    for (const key of waiting.keys()) waiting.set(key, discard);
    if (!waiting.size) ask(...discard);
    note(tr`Cancelled.`);
  },
  lock(on) {
    this.locked = on;
    document.body.dataset.locked = on;
    for (const part of document.querySelectorAll('[data-edits]')) part.inert = on;
    el('lock').setAttribute('aria-pressed', on);
    el('lock').textContent = on ? tr`Unlock` : tr`Lock`;
    if (state.edits) this.show(state.edits);
  },
};
for (const which of ['undo', 'redo']) el(which).addEventListener('click', () => Edits.back(which));
el('lock').addEventListener('click', () => Edits.lock(!Edits.locked));
addEventListener('pointerdown', () => { Edits.held = true; Edits.cancelled = false; }, true);
for (const kind of ['pointerup', 'pointercancel']) addEventListener(kind, () => { Edits.held = false; }, true);
