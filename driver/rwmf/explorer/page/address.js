// The state of the page in the fragment of the address, behind the token. The browser's history
// undoes and redoes it, and a link opens it in another browser.

export const token = () => location.hash.slice(1).split("&")[0];

export class Address {
  // `restore` receives the state of an address that the user goes to, null for the case itself.
  constructor(restore) {
    this.at = history.state?.at ?? 0;
    this.latest = this.at;
    addEventListener("popstate", (event) => {
      // a link pasted into the same tab has no place in the history yet
      if (!event.state) {
        this.latest = ++this.at;
        history.replaceState({ at: this.at }, "");
      } else this.at = event.state.at;
      this.latest = Math.max(this.latest, this.at);
      restore(this.read());
    });
    if (!history.state) history.replaceState({ at: 0 }, "");
  }

  // The state that the address contains; null for none, and for a damaged one.
  read() {
    const [, text] = location.hash.slice(1).split("&");
    if (!text) return null;
    try {
      return JSON.parse(decodeURIComponent(text));
    } catch {
      return null;
    }
  }

  // Add a state to the history; null for the case itself.
  write(state) {
    const hash = `#${token()}${state ? `&${encodeURIComponent(JSON.stringify(state))}` : ""}`;
    if (hash === location.hash) return;
    this.latest = ++this.at;
    history.pushState({ at: this.at }, "", hash);
  }

  get canUndo() { return this.at > 0; }

  get canRedo() { return this.at < this.latest; }
}
