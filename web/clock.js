// One time for everything on the page: it runs, stops, and is set from anywhere.

export class Clock {
  constructor(end, open) {
    this.end = end;
    this.time = open;
    this.speed = 2;
    this.playing = false;
    this.listeners = [];
  }

  listen(listener) {
    this.listeners.push(listener);
  }

  seek(time) {
    this.time = Math.min(Math.max(time, 0), this.end);
    this.tell();
  }

  toggle() {
    if (!this.playing && this.time >= this.end) this.time = 0;
    this.playing = !this.playing;
    this.last = performance.now();
    if (this.playing) requestAnimationFrame((now) => this.tick(now));
    this.tell();
  }

  tick(now) {
    if (!this.playing) return;
    this.time = Math.min(this.time + (this.speed * Math.max(now - this.last, 0)) / 1000, this.end);
    this.last = now;
    if (this.time >= this.end) this.playing = false;
    else requestAnimationFrame((next) => this.tick(next));
    this.tell();
  }

  tell() {
    for (const listener of this.listeners) listener(this.time);
  }
}
