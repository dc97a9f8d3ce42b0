!> Recorded ground accelerations: one column, two columns or PEER's AT2 format.
!>
!> Words are separated by blanks or commas. Lines that begin with `#` and one header line before the
!> numbers are skipped. Sample 1 of one-column and AT2 records is at t = 0.
module rwmf_input_record_record_reader
   use rwmf_core_error, only: err_input, error_t, fail
   use rwmf_core_kinds, only: dp, wp
   use rwmf_input_record_at2, only: has_at2_header, read_at2
   use rwmf_input_record_columns, only: read_columns
   use rwmf_input_record_samples, only: samples_t
   use rwmf_problem_record, only: record_t, set_factor
   use rwmf_text_crc32, only: crc32
   use rwmf_text_file, only: read_file
   implicit none
   private

   public :: read_record, parse_record, make_record

contains

   !> Read a record from a file.
   !>
   !> Errors: those of `read_file` and `parse_record`.
   subroutine read_record(path, dt, unit, scale, g, record, error)
      character(*), intent(in) :: path
      !! path of the file
      real(wp), intent(in), optional :: dt
      !! sampling interval of a one-column record [s]; must be absent for the other formats
      character(*), intent(in), optional :: unit
      !! 'g', 'm/s2' or 'cm/s2'; must be absent for AT2, which is in g
      real(wp), intent(in) :: scale
      !! factor on the accelerations [-]
      real(wp), intent(in) :: g
      !! acceleration of unit 'g' [m/s2]
      type(record_t), intent(out) :: record
      type(error_t), allocatable, intent(out) :: error
      character(:), allocatable :: bytes

      call read_file(path, bytes, error)
      if (.not. allocated(error)) then
         call parse_record(bytes, dt, unit, scale, g, record, error)
      end if
   end subroutine read_record

   !> Read a record from the text of its file.
   !>
   !> Errors: an invalid line, numbers that do not match NPTS, and those of `make_record`. Times
   !> that do not increase are an error too.
   subroutine parse_record(bytes, dt, unit, scale, g, record, error)
      character(*), intent(in) :: bytes
      !! the whole file, lines with their line feeds
      real(wp), intent(in), optional :: dt
      !! as in `read_record` [s]
      character(*), intent(in), optional :: unit
      !! 'g', 'm/s2' or 'cm/s2'; must be absent for AT2, which is in g
      real(wp), intent(in) :: scale
      !! factor on the accelerations [-]
      real(wp), intent(in) :: g
      !! acceleration of unit 'g' [m/s2]
      type(record_t), intent(out) :: record
      type(error_t), allocatable, intent(out) :: error
      type(samples_t) :: samples

      if (has_at2_header(bytes)) then
         samples%format = 'AT2'
         allocate (samples%dt)
         call read_at2(bytes, samples%dt, samples%a, error)
      else
         call read_columns(bytes, samples%t, samples%a, error)
         samples%format = 'one column'
         if (allocated(samples%t)) samples%format = 'two columns'
      end if
      if (allocated(error)) return
      samples%crc32 = crc32(bytes)
      call make_record(samples, dt, unit, scale, g, record, error)
   end subroutine parse_record

   !> Make a record from its samples.
   !>
   !> Errors: fewer than two samples, `dt` or `unit` missing or not allowed, overflow.
   subroutine make_record(samples, dt, unit, scale, g, record, error)
      type(samples_t), intent(in) :: samples
      real(wp), intent(in), optional :: dt
      !! interval of samples that have neither times nor an interval [s]
      character(*), intent(in), optional :: unit
      !! 'g', 'm/s2' or 'cm/s2'; must be absent for AT2, which is in g
      real(wp), intent(in) :: scale
      !! factor on the accelerations [-]
      real(wp), intent(in) :: g
      !! acceleration of unit 'g' [m/s2]
      type(record_t), intent(out) :: record
      type(error_t), allocatable, intent(out) :: error

      call check_keys(samples, dt, unit, error)
      if (allocated(error)) return
      record%format = samples%format
      record%crc32 = samples%crc32
      if (allocated(samples%dt)) then
         record%dt = real(samples%dt, wp)
      else if (present(dt)) then
         record%dt = dt
      end if
      call set_times(record, size(samples%a), samples%t)
      call set_accelerations(record, samples%a)
      call set_factor(record, scale, g, error, unit)
   end subroutine make_record

   !> Check that the keys are given exactly if the samples need them.
   subroutine check_keys(samples, dt, unit, error)
      type(samples_t), intent(in) :: samples
      real(wp), intent(in), optional :: dt
      !! [s]
      character(*), intent(in), optional :: unit
      type(error_t), allocatable, intent(out) :: error

      logical :: has_times

      has_times = allocated(samples%t) .or. allocated(samples%dt)
      if (size(samples%a) < 2) then
         call fail(error, err_input, 'a record needs at least 2 samples')
      else if (.not. (has_times .or. present(dt))) then
         call fail(error, err_input, 'the record has one column: it needs the key dt [s]')
      else if (has_times .and. present(dt)) then
         call fail(error, err_input, 'the record ('//samples%format//') has its own times: dt ' &
            //'must not be given')
      else if (samples%format == 'AT2' .and. present(unit)) then
         call fail(error, err_input, 'the record (AT2) is in g: unit must not be given')
      else if (samples%format /= 'AT2' .and. .not. present(unit)) then
         call fail(error, err_input, 'the record ('//samples%format//") needs the key unit: 'g', " &
            //"'m/s2' or 'cm/s2'")
      end if
   end subroutine check_keys

   !> Set the times of the samples, and their interval if it is uniform.
   subroutine set_times(record, n, t)
      type(record_t), intent(inout) :: record
      !! record; its `dt` is already set for formats without times
      integer, intent(in) :: n
      real(dp), allocatable, intent(in) :: t(:)
      !! (n) [s], allocated if the file has times
      real(wp), parameter :: printed_digits = 1e-4_wp
      !! rounding of printed times that is accepted as uniform, over dt [-]
      real(wp) :: dt
      integer :: i

      record%n = n
      allocate (record%t(n))
      if (.not. allocated(t)) then
         record%t(:) = [(real(i - 1, wp)*record%dt, i=1, n)]
         record%t_last = record%t(n)
         return
      end if
      record%t(:) = real(t, wp)
      record%t_last = record%t(n)
      dt = (record%t(n) - record%t(1))/real(n - 1, wp)
      do i = 1, n
         if (abs(record%t(i) - record%t(1) - real(i - 1, wp)*dt) > printed_digits*dt) return
      end do
      record%dt = dt
   end subroutine set_times

   !> Set the accelerations and their largest magnitude.
   subroutine set_accelerations(record, a)
      type(record_t), intent(inout) :: record
      !! record with its times
      real(dp), intent(in) :: a(:)
      !! (n) as in the file
      integer :: at

      record%a = real(a, wp)
      at = maxloc(abs(record%a), dim=1)
      record%largest = abs(record%a(at))
      record%t_peak = record%t(at)
   end subroutine set_accelerations

end module rwmf_input_record_record_reader
