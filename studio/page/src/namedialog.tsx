// A project's name, which is its folder's.
import type { JSX } from "preact";
import { useState } from "preact/hooks";
import * as api from "./api";
import { Dialog } from "./parts";
import * as state from "./state";

export function NameDialog(props: { id: string; open: boolean; onClose: () => void; named: (id: string) => void }): JSX.Element {
  const [name, setName] = useState(props.id);
  const rename = async (): Promise<void> => {
    try {
      const id = await api.renameProject(props.id, name);
      props.onClose();
      props.named(id);
    } catch (fault) {
      state.toast.value = (fault as Error).message;
    }
  };
  return (
    <Dialog title="Rename" open={props.open} onClose={props.onClose}>
      <form
        class="name-form"
        onSubmit={(event) => {
          event.preventDefault();
          void rename();
        }}
      >
        <label class="field">
          <span>Name</span>
          <input value={name} autofocus onInput={(event) => setName(event.currentTarget.value)} />
        </label>
        <button type="submit" class="primary" disabled={name.trim() === ""}>
          Rename
        </button>
      </form>
    </Dialog>
  );
}
