// SPDX-License-Identifier: Apache-2.0
// The keyboard. Letters and numbers are those of the viewfinder (docs/reference/devices.md).
'use strict';

const is_text = node => node.matches('textarea, select, input:not([type=range]):not([type=checkbox]):not([type=color])');
const takes_space = node => node.matches('button, input, select, textarea, summary, a');

const views = ['composite', 'plate', 'key', 'depth', 'light', 'matte'];
const keys = {
  r: () => el('record').click(),
  ' ': () => el('freeze').click(),
  l: () => Edits.lock(!Edits.locked),
  c: () => { const r = (state.takes || []).at(-1); if (r && r.frames) ask('PUT', thing_path('takes', r.name), { circled: !r.circled }); },
  m: () => tell(''),
  0: () => Views.choose('program'),
  '?': () => showHelp(),
  h: () => showHelp(),
};
views.forEach((view, i) => { keys[i + 1] = () => Views.choose(view); });

const help = [['R', tr`Begin and end a recording`], ['C', tr`Circle the last take`], ['0', tr`Program`],
  [tr`1 to 6`, tr`Composite, plate, key, depth, light, matte`], [tr`Space`, tr`Freeze`], ['Ctrl+Z', tr`Undo`],
  ['Ctrl+Shift+Z', tr`Redo`], ['Escape', tr`Cancel what is being dragged or placed`], ['L', tr`Lock and unlock this page`],
  ['M', tr`Close the message`], [tr`Tab, arrows`, tr`Choose a mark, move it; with Shift in larger steps`], ['H, ?', tr`This list`]];
el('help-keys').append(...help.flatMap(([key, does]) => [make('dt', {}, make('kbd', {}, key)), make('dd', {}, does)]));
function showHelp() { if (el('help').open) el('help').close(); else el('help').showModal(); }
el('help-open').addEventListener('click', showHelp);
el('help-close').addEventListener('click', () => el('help').close());

addEventListener('keydown', e => {
  if (e.key === 'Escape') {
    if (dragged) cancelDrag();
    else if (Edits.held) Edits.cancel();
    else { setFocusing(false); setAddingLamp(false); }
    return;
  }
  Edits.cancelled = false;
  const letter = e.key.toLowerCase();
  if ((e.ctrlKey || e.metaKey) && !e.altKey) {
    const undoes = letter === 'z' && !e.shiftKey, redoes = letter === 'y' || (letter === 'z' && e.shiftKey);
    // Text that is being written has its own undo.
    if (!(undoes || redoes) || e.target.matches('textarea, input:not([type]), input[type=text]')) return;
    e.preventDefault();
    Edits.back(undoes ? 'undo' : 'redo');
    return;
  }
  if (e.ctrlKey || e.metaKey || e.altKey || e.repeat || is_text(e.target) || !keys[letter]) return;
  if (letter === ' ' && takes_space(e.target)) return;
  e.preventDefault();
  keys[letter]();
});
