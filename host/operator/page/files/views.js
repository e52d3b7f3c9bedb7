// SPDX-License-Identifier: Apache-2.0
// The view of this browser: one of its own, or the program, which everybody shares.
'use strict';

const Views = {
  own: sessionStorage.getItem('view') || 'program',

  show() {
    const program = state.view || 'composite';
    const shown = this.own === 'program' ? program : this.own;
    for (const tab of document.querySelectorAll('[data-view]')) {
      const on = tab.dataset.view === this.own;
      tab.setAttribute('aria-selected', on);
      tab.tabIndex = on ? 0 : -1;
      if (tab.dataset.view === 'program') set(tab, 'textContent', tr`Program: ${tr(program)}`);
    }
    el('canvas').setAttribute('aria-label', tr`Live picture: ${tr(shown)}`);
    el('to-program').hidden = this.own === 'program' || this.own === program;
    if (state.view) Picture.show(shown);
  },
  choose(view) {
    this.own = view;
    sessionStorage.setItem('view', view);
    this.show();
  },
};
const tabs = [...document.querySelectorAll('[data-view]')];
for (const tab of tabs) {
  tab.addEventListener('click', () => Views.choose(tab.dataset.view));
  tab.addEventListener('keydown', e => {
    const next = e.key === 'ArrowRight' ? tab.nextElementSibling
      : e.key === 'ArrowLeft' ? tab.previousElementSibling : null;
    if (next) { next.focus(); next.click(); }
  });
}
el('to-program').addEventListener('click', () => ask('PUT', 'view', { view: Views.own }));
