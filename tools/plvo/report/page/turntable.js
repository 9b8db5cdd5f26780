// SPDX-License-Identifier: Apache-2.0
// Turns, moves and magnifies a view in space. Mouse: drag turns, drag with Shift or the right button moves, the wheel
// magnifies. Touch: one finger turns, two fingers move and magnify. A double click or double tap fits the view again.
function turntable(canvas, redraw) {
  const view = { yaw: 0.6, pitch: 0.45, zoom: 1, right: 0, down: 0, touched: false };  // right, down: shares of the width
  const held = new Map();  // what is pressed: pointer → [x, y] in pixels of the page
  const centre = () => [0, 1].map(k => [...held.values()].reduce((sum, at) => sum + at[k], 0) / held.size);
  const spread = () => {
    const [a, b] = [...held.values()];
    return Math.max(Math.hypot(a[0] - b[0], a[1] - b[1]), 10);
  };
  // Magnifies about a point of the canvas, which stays where it is.
  function magnify(factor, x, y) {
    const box = canvas.getBoundingClientRect();
    const zoom = Math.min(Math.max(view.zoom * factor, 0.05), 200);
    const real = zoom / view.zoom;
    const from = [(x - box.left - box.width / 2) / box.width, (y - box.top - box.height / 2) / box.width];
    view.right = from[0] + (view.right - from[0]) * real;
    view.down = from[1] + (view.down - from[1]) * real;
    view.zoom = zoom;
  }
  function fit() { Object.assign(view, { zoom: 1, right: 0, down: 0 }); }
  canvas.style.touchAction = "none";
  canvas.addEventListener("pointerdown", event => {
    canvas.setPointerCapture(event.pointerId);
    held.set(event.pointerId, [event.clientX, event.clientY]);
    view.touched = true;
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, event => held.delete(event.pointerId));
  canvas.addEventListener("pointermove", event => {
    if (!held.has(event.pointerId) || held.size > 2) return;
    const before = centre(), distance = held.size === 2 ? spread() : 0;
    held.set(event.pointerId, [event.clientX, event.clientY]);
    const after = centre(), dx = after[0] - before[0], dy = after[1] - before[1];
    if (held.size === 2 || event.shiftKey || event.buttons === 2) {
      view.right += dx / canvas.clientWidth;
      view.down += dy / canvas.clientWidth;
      if (held.size === 2) magnify(spread() / distance, ...after);
    } else {
      view.yaw -= dx * 0.01;
      view.pitch = Math.max(-1.5, Math.min(1.5, view.pitch + dy * 0.01));
    }
    redraw();
  });
  canvas.addEventListener("wheel", event => {
    event.preventDefault();
    view.touched = true;
    magnify(Math.exp(-event.deltaY * 0.001), event.clientX, event.clientY);
    redraw();
  }, { passive: false });
  canvas.addEventListener("contextmenu", event => event.preventDefault());
  canvas.addEventListener("dblclick", () => { fit(); redraw(); });
  // World and screen: x right, y down; z forward, away from the viewer.
  view.turned = ([x, y, z]) => {
    const a = Math.cos(view.yaw) * x + Math.sin(view.yaw) * z, b = -Math.sin(view.yaw) * x + Math.cos(view.yaw) * z;
    return [a, Math.cos(view.pitch) * y - Math.sin(view.pitch) * b, Math.cos(view.pitch) * b + Math.sin(view.pitch) * y];
  };
  return view;
}
