!> Static curves as flat procedures for f2py, in the extension `rwmf._kernel` beside
!> `rwmf_bindings_python_kernel`, whose conventions they follow.
module rwmf_bindings_python_static_curve
   use, intrinsic :: iso_c_binding, only: c_double, c_int, c_int64_t, c_int8_t
   use rwmf_bindings_python_handles, only: find, keep, kept_t, make_control, put_error, put_text
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_simulation_pushover_pushover, only: protocol_t, push_over
   implicit none
   public

contains

   !> Move the roof of a case through a protocol of drifts. `rows` is the largest number per leg.
   subroutine pushover(handle, pattern, forces, drifts, rows, control, curve, status, message, &
      message_length)
      integer(c_int64_t), intent(in) :: handle
      character(*), intent(in) :: pattern
      real(c_double), intent(in) :: forces(:)
      real(c_double), intent(in) :: drifts(:)
      integer(c_int), intent(in) :: rows
      integer(c_int64_t), intent(inout), target :: control(2)
      integer(c_int64_t), intent(out) :: curve
      integer(c_int), intent(out) :: status
      integer(c_int8_t), intent(inout) :: message(:)
      ! f2py declares the C type of int8 only when it is written this way at least once
      !f2py integer*1 :: message
      integer(c_int), intent(out) :: message_length
      type(kept_t), pointer :: from
      type(kept_t), pointer :: kept
      type(protocol_t) :: protocol
      type(error_t), allocatable :: error
      !f2py threadsafe

      from => find(handle)
      allocate (kept)
      allocate (kept%curve)
      protocol = protocol_t(pattern, real(forces, wp), real(drifts, wp), int(rows))
      call push_over(from%case, protocol, make_control(control), kept%curve, error)
      call keep(kept, error, curve)
      call put_error(error, status, message, message_length)
   end subroutine pushover

   !> Sizes and reference values of a curve. `weights` is the weight of the wall (bare frame: of
   !> the unit of mass), and of wall and frame [N]; 0 if the case has no mass.
   subroutine curve_shape(handle, curve, n_columns, n_rows, n_marks, n_loads, height, weights)
      integer(c_int64_t), intent(in) :: handle
      integer(c_int64_t), intent(in) :: curve
      integer(c_int), intent(out) :: n_columns
      integer(c_int), intent(out) :: n_rows
      integer(c_int), intent(out) :: n_marks
      integer(c_int), intent(out) :: n_loads
      real(c_double), intent(out) :: height
      real(c_double), intent(out) :: weights(2)
      type(kept_t), pointer :: from
      type(kept_t), pointer :: kept

      from => find(handle)
      kept => find(curve)
      n_columns = size(kept%curve%names, kind=c_int)
      n_rows = int(kept%curve%n, c_int)
      n_marks = 0_c_int
      if (allocated(kept%curve%marks)) n_marks = size(kept%curve%marks, kind=c_int)
      n_loads = size(kept%curve%pattern, kind=c_int)
      height = real(kept%curve%height, c_double)
      weights = real(from%case%unit_mass*[from%case%model%g, kept%curve%weight], c_double)
   end subroutine curve_shape

   !> Copy values (columns, rows), the rows of the marks, from 1, and the shares of the loads.
   subroutine curve_values(curve, values, mark_rows, pattern)
      integer(c_int64_t), intent(in) :: curve
      real(c_double), intent(inout) :: values(:, :)
      integer(c_int), intent(inout) :: mark_rows(:)
      real(c_double), intent(inout) :: pattern(:)
      type(kept_t), pointer :: kept

      kept => find(curve)
      values = real(kept%curve%values(:, :kept%curve%n), c_double)
      if (size(mark_rows) > 0) mark_rows = int(kept%curve%marks%step, c_int)
      pattern = real(kept%curve%pattern, c_double)
   end subroutine curve_values

   !> Ending of the path, names of the columns and names of the marks, separated by tabs.
   subroutine curve_names(curve, buffer, length)
      integer(c_int64_t), intent(in) :: curve
      integer(c_int8_t), intent(inout) :: buffer(:)
      integer(c_int), intent(out) :: length
      type(kept_t), pointer :: kept
      character(:), allocatable :: text
      integer :: i

      kept => find(curve)
      text = trim(kept%curve%ending)
      do i = 1, size(kept%curve%names)
         text = text//achar(9)//trim(kept%curve%names(i))
      end do
      if (allocated(kept%curve%marks)) then
         do i = 1, size(kept%curve%marks)
            text = text//achar(9)//trim(kept%curve%marks(i)%name)
         end do
      end if
      call put_text(text, buffer, length)
   end subroutine curve_names

end module rwmf_bindings_python_static_curve
