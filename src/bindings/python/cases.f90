!> Creation of cases from text, from samples in arrays, and from a stored case. Flat procedures for
!> f2py in the extension `rwmf._kernel` beside `rwmf_bindings_python_kernel`, with the same
!> conventions.
module rwmf_bindings_python_cases
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t, c_int8_t
   use rwmf_bindings_python_handles, only: add_source, find, keep, keep_motion, kept_t, &
      put_error, put_text, sampled_case, samples_of, get_text
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: dp, wp
   use rwmf_input_change, only: change_case, find_changes, is_motion_changed
   use rwmf_input_reader, only: read_case_text
   use rwmf_input_record_record_reader, only: complete_samples, read_facts, read_samples
   use rwmf_input_record_samples, only: samples_from_array, samples_t
   use rwmf_input_record_unit_names, only: unit_of, unit_t
   use rwmf_problem_case, only: case_t
   use rwmf_text_strings, only: integer_to_text, real_to_text
   implicit none
   public

contains

   !> Read and validate a case. `others` are handles, 0 for none: the first of a case whose records
   !> are reused where both name the same files. The others are samples in place of the records of
   !> `&motion` and `&vertical`.
   subroutine case_read(text, source, others, is_for_host, handle, status, message, &
      message_length)
      character(*), intent(in) :: text
      character(*), intent(in) :: source
      integer(c_int64_t), intent(in) :: others(3)
      integer(c_int), intent(in) :: is_for_host
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      ! f2py declares the C type of int8 only when it is written this way at least once
      !f2py integer*1 :: message
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(case_t), pointer :: case
      type(samples_t), pointer :: a
      type(samples_t), pointer :: v
      type(error_t), allocatable :: error
      !f2py threadsafe

      allocate (kept)
      allocate (kept%case)
      ! a missing object is a null pointer, passed as an absent argument
      case => sampled_case(others(1))
      a => samples_of(others(2))
      v => samples_of(others(3))
      call read_case_text(text, source(:index(source, '/', back=.true.)), kept%case, error, case, &
         a, v, is_for_host /= 0)
      call add_source(source, error)
      if (.not. allocated(error)) call keep_motion(kept)
      call keep(kept, error, handle)
      call put_error(error, status, message, message_length)
   end subroutine case_read

   !> Store samples of an array. With an empty array of times they follow the interval of the case.
   subroutine samples_keep(a, t, handle, status, message, message_length)
      real(c_double), intent(in) :: a(:)
      real(c_double), intent(in) :: t(:)
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: error
      !f2py threadsafe

      allocate (kept)
      allocate (kept%samples)
      if (size(t) > 0) then
         call samples_from_array(real(a, dp), kept%samples, error, real(t, dp))
      else
         call samples_from_array(real(a, dp), kept%samples, error)
      end if
      call keep(kept, error, handle)
      call put_error(error, status, message, message_length)
   end subroutine samples_keep

   !> Read the header of a record file: format 'AT2' or 'table', unit, number of channels, with tabs
   !> between them.
   subroutine record_header(bytes, buffer, length, status, message, message_length)
      integer(c_int8_t), intent(in) :: bytes(:)
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      character(*), parameter :: tab = achar(9)
      character(:), allocatable :: text
      character(:), allocatable :: unit
      type(error_t), allocatable :: error
      logical :: is_at2
      integer :: n

      call get_text(bytes, text)
      call read_facts(text, is_at2, unit, n, error)
      call put_text(trim(merge('AT2  ', 'table', is_at2))//tab//unit//tab &
         //trim(integer_to_text(n)), buffer, length)
      call put_error(error, status, message, message_length)
   end subroutine record_header

   !> Read the samples of a record file; return its number of channels. An empty `unit` and an
   !> interval of 0 are absent.
   subroutine record_read(bytes, unit, dt, handle, n_channels, status, message, message_length)
      integer(c_int8_t), intent(in) :: bytes(:)
      character(*), intent(in) :: unit
      real(c_double), intent(in) :: dt
      integer(c_int64_t), intent(out) :: handle
      integer(c_int), intent(out) :: n_channels
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: error
      character(:), allocatable :: text
      character(:), allocatable :: key
      real(dp), allocatable :: step
      integer :: i
      !f2py threadsafe

      allocate (kept)
      ! an unallocated argument is absent
      if (unit /= '') key = trim(unit)
      if (dt > 0) step = real(dt, dp)
      call get_text(bytes, text)
      call read_samples(text, kept%channels, error)
      n_channels = 0_c_int
      if (allocated(kept%channels)) n_channels = size(kept%channels, kind=c_int)
      do i = 1, n_channels
         if (.not. allocated(error)) call complete_samples(kept%channels(i), step, key, error)
      end do
      call keep(kept, error, handle)
      call put_error(error, status, message, message_length)
   end subroutine record_read

   !> Unit of a text: quantity and base, with a tab between them, and its ratio to the base.
   subroutine unit_named(text, ratio, buffer, length)
      character(*), intent(in) :: text
      real(c_double), intent(inout) :: ratio(2)
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      type(unit_t) :: unit

      unit = unit_of(text)
      ratio = [real(unit%times, c_double), real(unit%over, c_double)]
      call put_text(trim(unit%quantity)//achar(9)//trim(unit%base), buffer, length)
   end subroutine unit_named

   !> Facts of a channel of a file: format, unit, name, interval [s] ('' for none), number of
   !> samples, and 1 with times, with tabs between them.
   subroutine channel_facts(handle, channel, buffer, length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: channel
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      character(*), parameter :: tab = achar(9)
      character(:), allocatable :: dt
      type(kept_t), pointer :: kept

      kept => find(handle)
      associate (samples => kept%channels(channel))
         dt = ''
         if (allocated(samples%dt)) dt = trim(real_to_text(real(samples%dt, wp)))
         call put_text(samples%format//tab//samples%unit//tab//samples%name//tab//dt//tab &
            //trim(integer_to_text(size(samples%a)))//tab &
            //merge('1', '0', allocated(samples%t)), buffer, length)
      end associate
   end subroutine channel_facts

   !> Copy the samples of a channel; its times only if it has some.
   subroutine channel_samples(handle, channel, a, t)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int), intent(in) :: channel
      real(c_double), intent(inout) :: a(:)
      real(c_double), intent(inout) :: t(:)
      type(kept_t), pointer :: kept

      kept => find(handle)
      a = real(kept%channels(channel)%a, c_double)
      if (size(t) > 0) t = real(kept%channels(channel)%t, c_double)
   end subroutine channel_samples

   !> Find the keys to change from their names, separated by blanks, and return the number of values
   !> of each.
   subroutine changes_find(handle, names, n_values, changes, status, message, message_length)
      integer(c_int64_t), intent(in) :: handle
      character(*), intent(in) :: names
      integer(c_int), intent(in) :: n_values(:)
      integer(c_int64_t), intent(out) :: changes
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: from
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: error
      character(40) :: list(size(n_values))

      from => find(handle)
      allocate (kept)
      allocate (kept%changes)
      read (names, *, iostat=status) list
      call find_changes(from%case, list, kept%changes, error, int(n_values))
      call keep(kept, error, changes)
      call put_error(error, status, message, message_length)
   end subroutine changes_find

   !> Create a case with changed numbers. The samples of its records, and their motion, remain with
   !> the original case.
   subroutine case_change(handle, changes, numbers, source, changed, status, message, &
      message_length)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(in) :: changes
      real(c_double), intent(in) :: numbers(:)
      character(*), intent(in) :: source
      integer(c_int64_t), intent(out) :: changed
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: from
      type(kept_t), pointer :: keys
      type(kept_t), pointer :: kept
      type(error_t), allocatable :: error

      from => find(handle)
      keys => find(changes)
      allocate (kept)
      allocate (kept%case)
      kept%origin => from
      if (associated(from%origin)) kept%origin => from%origin
      kept%is_motion_of_origin = .not. is_motion_changed(keys%changes)
      if (associated(from%origin)) then
         kept%is_motion_of_origin = kept%is_motion_of_origin .and. from%is_motion_of_origin
      end if
      call change_case(from%case, keys%changes, real(numbers, dp), kept%case, error)
      call add_source(source, error)
      if (.not. allocated(error)) call keep_motion(kept)
      call keep(kept, error, changed)
      call put_error(error, status, message, message_length)
   end subroutine case_change

   !> Number of ordinates of the spectrum of a case; 0 without `&spectrum`.
   subroutine ordinates(handle, n)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(out) :: n
      type(kept_t), pointer :: kept

      kept => find(handle)
      n = 0_c_int64_t
      if (.not. allocated(kept%case%spectrum)) return
      associate (grid => kept%case%spectrum)
         if (allocated(grid%T_s)) then
            n = size(grid%T_s, kind=c_int64_t)
         else
            n = int(grid%n, c_int64_t)
         end if
         if (allocated(grid%gamma)) n = n*size(grid%gamma, kind=c_int64_t)
         if (allocated(grid%b)) n = n*size(grid%b, kind=c_int64_t)
      end associate
   end subroutine ordinates

end module rwmf_bindings_python_cases
