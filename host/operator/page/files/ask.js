// SPDX-License-Identifier: Apache-2.0
// Shared by all of the page: the last state received, elements, and requests for changes.
'use strict';

const state = {};
const el = id => document.getElementById(id);

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
// A control that is being used keeps what the user does, until it is taken back.
let again_until_ms = 0;
function showAgain() { again_until_ms = performance.now() + 1500; }
function setValue(node, value) {
  if (document.activeElement !== node || performance.now() < again_until_ms) set(node, 'value', String(value));
}

// One line under the header: an error stays until it is read, a note goes by itself.
let message_timer = 0;
function tell(text, undo) {
  el('message-text').textContent = text;
  el('message').hidden = !text;
  el('message').className = 'bad-message';
  el('message-undo').hidden = !undo;
  clearTimeout(message_timer);
}
function note(text, undo) {
  tell(text, undo);
  el('message').className = '';
  message_timer = setTimeout(() => tell(''), undo ? 12000 : 5000);
}
el('message-close').addEventListener('click', () => tell(''));
el('message-undo').addEventListener('click', () => Edits.back('undo'));

async function ask(method, path, body, type) {
  try {
    const answer = await fetch('/api/v1/' + path, {
      method, body: type ? body : JSON.stringify(body || {}),
      headers: { 'Content-Type': type || 'application/json' } });
    if (answer.ok) return true;
    tell((await answer.json()).error || tr`The rig refused this change (HTTP status ${answer.status}).`);
  } catch (error) {
    tell(tr`The rig does not answer: check that mixrig runs and that the network reaches it.`);
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
// A change by a control; what Escape has cancelled does not come.
function change(key, path, body) {
  if (Edits.locked || Edits.cancelled) return;
  askNewest(key, 'PUT', path, body);
}
const thing_path = (kind, name) => `${kind}/${encodeURIComponent(name)}`;
